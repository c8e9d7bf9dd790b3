// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/whole_body.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace tuina::robot {
namespace {

constexpr double radian_m = 0.3;  // a radian of tool direction counts like so many metres
constexpr double close_m = 1e-5, close_rad = 1e-3;
constexpr double max_step = 0.2, to_middle = 0.02;
constexpr int max_iterations = 300;

/// What is still missing for one tool, and how the joints change it.
struct Missing {
  Eigen::Matrix<double, 6, 1> error;
  Eigen::MatrixXd jacobian;
  double off_m, tilt_rad;
};

Missing missing_for(const Description& robot, const std::vector<double>& q, const Marker& tool,
                    const ContactGoal& goal, double tool_radius_m) {
  const MarkerKinematics now = kinematics_of(robot, q, tool);
  const Vector3 axis = now.base_from_marker.linear().col(0);
  const Vector3 centre = goal.at_in_base + tool_radius_m * goal.normal_in_base;
  const Vector3 off = centre - now.base_from_marker.translation();
  const Vector3 across = axis.cross(-goal.normal_in_base);
  const double tilt_rad = std::atan2(across.norm(), -axis.dot(goal.normal_in_base));
  // A tool that points straight backwards may turn about anything across its axis.
  const Vector3 about =
      across.norm() > 1e-9 ? Vector3(across.normalized()) : Vector3(axis.unitOrthogonal());
  Missing missing{.jacobian = now.jacobian, .off_m = off.norm(), .tilt_rad = tilt_rad};
  missing.error << off, radian_m * tilt_rad * about;
  // Turning about the tool's own axis is free.
  const Matrix3 matters = Matrix3::Identity() - axis * axis.transpose();
  missing.jacobian.bottomRows(3) = radian_m * matters * now.jacobian.bottomRows(3);
  return missing;
}

std::vector<std::size_t> joints_named(const Description& robot,
                                      const std::vector<std::string>& names) {
  std::vector<std::size_t> joints;
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const bool named = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return robot.parts[i].name.starts_with(name);
    });
    if (named && robot.parts[i].motion != Part::Motion::fixed) joints.push_back(i);
  }
  return joints;
}

/// One Gauss-Newton step; far from the goal damped, so that a singular posture does not leap. A
/// joint that would leave its range stands still, and the others do without it.
Eigen::VectorXd step_towards(const Description& robot, const std::vector<double>& q,
                             const std::vector<std::size_t>& joints, Eigen::MatrixXd J,
                             const Eigen::VectorXd& error) {
  const Eigen::Index n = J.cols();
  const double damping = 1e-8 + 1e-2 * std::min(error.squaredNorm(), 1.0);
  Eigen::VectorXd wish(n), step = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::size_t i = joints[static_cast<std::size_t>(j)];
    const Part& part = robot.parts[i];
    wish[j] = part.limited ? to_middle * (0.5 * (part.lowest + part.highest) - q[i]) : 0.0;
  }
  for (bool all_within = false; !all_within;) {
    const Eigen::LDLT<Eigen::MatrixXd> solver(
        J * J.transpose() + damping * Eigen::MatrixXd::Identity(J.rows(), J.rows()));
    step = J.transpose() * solver.solve(error) + wish - J.transpose() * solver.solve(J * wish);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > max_step) step *= max_step / longest;
    all_within = true;
    for (Eigen::Index j = 0; j < n; ++j) {
      const std::size_t i = joints[static_cast<std::size_t>(j)];
      const Part& part = robot.parts[i];
      const bool leaves =
          (q[i] <= part.lowest && step[j] < 0.0) || (q[i] >= part.highest && step[j] > 0.0);
      if (!part.limited || !leaves) continue;
      J.col(j).setZero();
      wish[j] = 0.0;
      all_within = false;
    }
  }
  return step;
}

}  // namespace

const Marker* find_marker(const Description& robot, const std::string& name) {
  const auto found = std::find_if(robot.markers.begin(), robot.markers.end(),
                                  [&](const Marker& marker) { return marker.name == name; });
  return found == robot.markers.end() ? nullptr : &*found;
}

MarkerKinematics kinematics_of(const Description& robot, const std::vector<double>& q,
                               const Marker& marker) {
  const std::vector<Transform> poses = base_from_parts(robot, q);
  MarkerKinematics result;
  result.base_from_marker = poses[static_cast<std::size_t>(marker.part)] * marker.part_from_marker;
  result.jacobian.setZero(6, static_cast<Eigen::Index>(robot.parts.size()));
  const Vector3 at = result.base_from_marker.translation();
  for (int i = marker.part; i >= 0; i = robot.parts[static_cast<std::size_t>(i)].parent) {
    const Part& part = robot.parts[static_cast<std::size_t>(i)];
    const Transform& pose = poses[static_cast<std::size_t>(i)];
    const Vector3 axis = pose.linear() * part.axis;
    if (part.motion == Part::Motion::hinge)
      result.jacobian.col(i) << axis.cross(at - pose.translation()), axis;
    else if (part.motion == Part::Motion::slide)
      result.jacobian.col(i).head<3>() = axis;
  }
  return result;
}

WholePosture reach_with(const Description& robot, std::vector<double> q,
                        const PerArm<std::optional<ContactGoal>>& goals, double tool_radius_m,
                        const std::vector<std::string>& moving) {
  const std::vector<std::size_t> joints = joints_named(robot, moving);
  const auto n = static_cast<Eigen::Index>(joints.size());
  WholePosture posture;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    Eigen::MatrixXd J(0, n);
    Eigen::VectorXd error(0);
    posture.worst_m = posture.worst_tilt_rad = 0.0;
    for (const Arm arm : both_arms) {
      const Marker* tool = find_marker(robot, std::string(name_of(arm)) + "_tool");
      if (!goals[arm] || tool == nullptr) continue;
      const Missing missing = missing_for(robot, q, *tool, *goals[arm], tool_radius_m);
      const Eigen::Index row = J.rows();
      J.conservativeResize(row + 6, Eigen::NoChange);
      error.conservativeResize(row + 6);
      error.tail<6>() = missing.error;
      for (Eigen::Index j = 0; j < n; ++j)
        J.col(j).tail<6>() =
            missing.jacobian.col(static_cast<Eigen::Index>(joints[static_cast<std::size_t>(j)]));
      posture.worst_m = std::max(posture.worst_m, missing.off_m);
      posture.worst_tilt_rad = std::max(posture.worst_tilt_rad, missing.tilt_rad);
    }
    posture.reached = posture.worst_m < close_m && posture.worst_tilt_rad < close_rad;
    if (posture.reached || J.rows() == 0) break;

    const Eigen::VectorXd step = step_towards(robot, q, joints, J, error);
    for (Eigen::Index j = 0; j < n; ++j) {
      const std::size_t i = joints[static_cast<std::size_t>(j)];
      q[i] += step[j];
      if (robot.parts[i].limited)
        q[i] = std::clamp(q[i], robot.parts[i].lowest, robot.parts[i].highest);
    }
  }
  posture.q = std::move(q);
  return posture;
}

}  // namespace tuina::robot
