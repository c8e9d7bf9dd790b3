// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "tuina/control/arm_controller.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/guard.hpp"

namespace tuina::session {

/// One arm, its controller and the guard that has the last word. Every loop that moves an arm does
/// so through this: sense, propose, allow. Real-time; memory is taken in the constructor.
class GuardedArm {
 public:
  /// `model` must outlive it. `max_set_force_n` lowers the guard's ceilings, in every zone.
  explicit GuardedArm(const robot::ArmModel& model,
                      const control::ArmController::Options& options = {},
                      double max_set_force_n = std::numeric_limits<double>::infinity());

  /// Reads the sensors of this arm; the first reading is where the controller starts.
  void sense(const robot::RobotReading& reading, Arm arm) noexcept;
  /// The torques that the controller wants in this millisecond.
  [[nodiscard]] JointVector torque_nm(const robot::RobotReading& reading) noexcept;
  /// What the guard makes of a proposal in this millisecond; `dynamics` are those of `state`.
  const JointVector& allow(const robot::RobotReading& reading, Arm arm,
                           const robot::ArmDynamics& dynamics,
                           const safety::Proposal& proposal) noexcept;
  /// The controller's torques, guarded as in a workshop: nobody plans what the tool touches.
  const JointVector& step_on_bench(const robot::RobotReading& reading, Arm arm) noexcept;

  control::ArmController controller;
  ArmState state;           ///< sensed state of this millisecond
  safety::Verdict verdict;  ///< verdict of this millisecond

 private:
  safety::Guard guard_;
  bool started_ = false;
};

}  // namespace tuina::session
