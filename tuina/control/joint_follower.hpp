// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/tool_motion.hpp"
#include "tuina/robot/arm_model.hpp"

namespace tuina::control {

/// Joint angles that keep the tool's centre and axis on a moving reference, for the laws that
/// control joints: one damped Newton step per tick from the angles of the tick before.
class JointFollower {
 public:
  void start(const JointVector& q_rad) noexcept { q_rad_ = q_rad; }
  /// The angles for this tick. Near a singular pose they fall behind rather than jump.
  const JointVector& step(const robot::ArmModel& model, double rail_m, const ToolPose& centre,
                          const JointVector& posture_rad) noexcept;

 private:
  JointVector q_rad_;
};

}  // namespace tuina::control
