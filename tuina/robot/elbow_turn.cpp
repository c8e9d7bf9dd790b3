// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/elbow_turn.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace tuina::robot {
namespace {

using ToolJacobian = Eigen::Matrix<double, 5, Eigen::Dynamic, 0, 5, max_joints>;
using ToolError = Eigen::Matrix<double, 5, 1>;

constexpr double step_rad = 6_deg;  // turn of the joint that turns most

/// Tip and axis of the tool; turning about its own axis is free.
struct Hold {
  Vector3 centre_in_base, axis_in_base;

  [[nodiscard]] ToolJacobian jacobian(const ArmModel::Kinematics& now, ToolError& error) const {
    const Vector3 axis = now.base_from_tool.linear().col(0);
    const Vector3 across = axis.unitOrthogonal(), over = axis.cross(across);
    const Vector3 turn = axis.cross(axis_in_base);
    ToolJacobian J(5, now.jacobian.cols());
    J.topRows<3>() = now.jacobian.topRows<3>();
    J.row(3) = across.transpose() * now.jacobian.bottomRows<3>();
    J.row(4) = over.transpose() * now.jacobian.bottomRows<3>();
    error << centre_in_base - now.base_from_tool.translation(), turn.dot(across), turn.dot(over);
    return J;
  }
};

/// The least change of the joints that the tool follows.
JointVector min_step(const ToolJacobian& J, const ToolError& wanted) {
  constexpr double damping = 1e-4;
  const Eigen::Matrix<double, 5, 5> square =
      J * J.transpose() + damping * damping * Eigen::Matrix<double, 5, 5>::Identity();
  return J.transpose() * square.llt().solve(wanted);
}

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
  constexpr double held_m = 0.2e-3;
  ArmModel::Kinematics now = arm.kinematics(q_rad, rail_m);
  const Hold hold{now.base_from_tool.translation(), now.base_from_tool.linear().col(0)};
  std::vector<JointVector> postures;
  for (int n = 0; n < max_steps; ++n) {
    ToolError error;
    ToolJacobian J = hold.jacobian(now, error);
    const JointVector gradient = elbow_gradient(arm, now);
    const JointVector turn = gradient - min_step(J, J * gradient);
    const double most = turn.cwiseAbs().maxCoeff();
    if (!(most > 1e-3)) break;  // m/rad: no joint turns the elbow any more
    q_rad += side * step_rad / most * turn;
    for (int i = 0; i < corrections; ++i) {
      now = arm.kinematics(q_rad, rail_m);
      J = hold.jacobian(now, error);
      q_rad += min_step(J, error);
    }
    now = arm.kinematics(q_rad, rail_m);
    const double off_m = (hold.centre_in_base - now.base_from_tool.translation()).norm();
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
