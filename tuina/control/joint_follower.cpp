// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/joint_follower.hpp"

#include "tuina/robot/tool_task.hpp"

namespace tuina::control {

const JointVector& JointFollower::step(const robot::ArmModel& model, double rail_m,
                                       const ToolPose& centre,
                                       const JointVector& posture_rad) noexcept {
  constexpr double damping = 1e-3, max_step_rad = 4e-3, towards_posture = 1e-3;
  const auto now = model.kinematics(q_rad_, rail_m);
  const robot::ToolTask task =
      robot::tool_task(now, centre.at_in_base, -centre.normal_in_base);  // the tool points inward
  const JointVector step =
      robot::solve_step(task, damping, towards_posture * (posture_rad - q_rad_));
  q_rad_ += step.cwiseMax(-max_step_rad).cwiseMin(max_step_rad);
  return q_rad_;
}

}  // namespace tuina::control
