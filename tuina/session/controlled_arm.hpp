// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/arm_controller.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/guard.hpp"

namespace tuina::session {

/// One arm and its controller. Every loop that moves an arm does so through this: sense, propose;
/// the guard of the robot has the last word. Real-time; memory is taken in the constructor.
class ControlledArm {
 public:
  /// `model` must outlive it.
  explicit ControlledArm(const robot::ArmModel& model,
                         const control::ArmController::Options& options = {})
      : controller(model, options) {}

  /// Reads the sensors of this arm; the first reading is where the controller starts.
  void sense(const robot::RobotReading& reading, Arm arm) noexcept;
  /// The torques that the controller wants in this millisecond.
  [[nodiscard]] JointVector torque_nm(const robot::RobotReading& reading) noexcept;
  /// These torques, and what the controller says of them, for a tool over `zone`.
  [[nodiscard]] safety::Proposal propose(const robot::RobotReading& reading,
                                         safety::Zone zone) noexcept;

  control::ArmController controller;
  ArmState state;  ///< sensed state of this millisecond

 private:
  bool started_ = false;
};

}  // namespace tuina::session
