// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/joint_follower.hpp"

#include <Eigen/Cholesky>

#include "tuina/control/cartesian_impedance.hpp"

namespace tuina::control {

const JointVector& JointFollower::step(const robot::ArmModel& model, double rail_m,
                                       const ToolPose& centre,
                                       const JointVector& posture_rad) noexcept {
  using Task = Eigen::Matrix<double, 5, Eigen::Dynamic, 0, 5, max_joints>;
  constexpr double damping = 1e-3, max_step_rad = 4e-3, towards_posture = 1e-3;
  const auto now = model.kinematics(q_rad_, rail_m);
  const Vector3 axis = tool_normal(now.base_from_tool);
  const Vector3 across = axis.unitOrthogonal(), over = axis.cross(across);
  const Vector3 turn = axis.cross(centre.normal_in_base);
  Task J(5, q_rad_.size());
  J.topRows<3>() = now.jacobian.topRows<3>();
  J.row(3) = across.transpose() * now.jacobian.bottomRows<3>();
  J.row(4) = over.transpose() * now.jacobian.bottomRows<3>();
  Eigen::Matrix<double, 5, 1> error;
  error << centre.at_in_base - now.base_from_tool.translation(), turn.dot(across), turn.dot(over);
  const JointVector drift = towards_posture * (posture_rad - q_rad_);
  const Eigen::Matrix<double, 5, 5> square =
      J * J.transpose() + damping * damping * Eigen::Matrix<double, 5, 5>::Identity();
  const Eigen::Matrix<double, 5, 1> rest = error - J * drift;
  const JointVector step = drift + J.transpose() * square.llt().solve(rest);
  q_rad_ += step.cwiseMax(-max_step_rad).cwiseMin(max_step_rad);
  return q_rad_;
}

}  // namespace tuina::control
