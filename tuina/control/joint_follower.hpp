// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/tool_motion.hpp"
#include "tuina/robot/arm_model.hpp"

namespace tuina::control {

/// Differential inverse kinematics for the joint-space laws: one damped Newton step per tick keeps
/// the tool centre and axis on a moving reference.
class JointFollower {
 public:
  /// Begins at these joint angles.
  void start(const JointVector& q_rad) noexcept { q_rad_ = q_rad; }
  /// Joint angles for this tick; near singular poses they lag instead of jumping.
  const JointVector& step(const robot::ArmModel& model, double rail_m, const ToolPose& centre,
                          const JointVector& posture_rad) noexcept;

 private:
  JointVector q_rad_;
};

}  // namespace tuina::control
