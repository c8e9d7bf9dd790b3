// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/elbow_turn.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/robot/tool_task.hpp"

namespace tuina::robot {
namespace {

constexpr double step_rad = 6_deg;  // turn of the joint that turns most

bool within_limits(const ArmTable& table, const JointVector& q_rad, double margin_rad) {
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    if (q_rad[i] < link.min_rad + margin_rad || q_rad[i] > link.max_rad - margin_rad) return false;
  }
  return true;
}

/// How the joints move the elbow about the line from the shoulder to the tool.
JointVector elbow_gradient(const ArmModel& arm, const ArmModel::Kinematics& now) {
  const std::size_t elbow = arm.elbow();
  const auto& origins = now.origins_in_base;
  const Vector3& shoulder = origins[elbow - 1];
  const Vector3 line = now.base_from_tool.translation() - shoulder;
  const Vector3 around = line.cross(origins[elbow] - shoulder).normalized();
  JointVector gradient = JointVector::Zero(arm.joints());
  for (std::size_t i = 0; i < elbow; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Vector3 axis = now.jacobian.col(column).tail<3>();
    gradient[column] = axis.cross(origins[elbow] - origins[i]).dot(around);
  }
  return gradient;
}

/// From `q_rad` on, to one side.
std::vector<JointVector> turned(const ArmModel& arm, double rail_m, JointVector q_rad, double side,
                                double margin_rad) {
  constexpr int max_steps = 60, corrections = 3;
  constexpr double held_m = 0.2e-3, damping = 1e-4;
  ArmModel::Kinematics now = arm.kinematics(q_rad, rail_m);
  const Vector3 origin_in_base = now.base_from_tool.translation();
  const Vector3 axis_in_base = now.base_from_tool.linear().col(0);
  std::vector<JointVector> postures;
  for (int n = 0; n < max_steps; ++n) {
    const JointVector gradient = elbow_gradient(arm, now);
    const ToolTask still{.jacobian = tool_jacobian(now.base_from_tool, now.jacobian),
                         .error = ToolError::Zero()};
    const JointVector turn = solve_step(still, damping, gradient);
    const double most = turn.cwiseAbs().maxCoeff();
    if (!(most > 1e-3)) break;  // m/rad: no joint turns the elbow any more
    q_rad += side * step_rad / most * turn;
    for (int i = 0; i < corrections; ++i) {
      now = arm.kinematics(q_rad, rail_m);
      const ToolTask back = tool_task(now, origin_in_base, axis_in_base);
      q_rad += solve_step(back, damping, JointVector::Zero(arm.joints()));
    }
    now = arm.kinematics(q_rad, rail_m);
    const double off_m = (origin_in_base - now.base_from_tool.translation()).norm();
    if (!(off_m < held_m) || !within_limits(arm.table(), q_rad, margin_rad)) break;
    postures.push_back(q_rad);
  }
  return postures;
}

}  // namespace

std::vector<JointVector> turn_elbow(const ArmModel& arm, double rail_m, const JointVector& q_rad,
                                    double limit_margin_rad) {
  std::vector<JointVector> postures = turned(arm, rail_m, q_rad, -1.0, limit_margin_rad);
  std::reverse(postures.begin(), postures.end());
  postures.push_back(q_rad);
  const auto others = turned(arm, rail_m, q_rad, 1.0, limit_margin_rad);
  postures.insert(postures.end(), others.begin(), others.end());
  return postures;
}

}  // namespace tuina::robot
