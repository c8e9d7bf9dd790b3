// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "tuina/core/arm.hpp"
#include "tuina/core/result.hpp"

namespace tuina::robot {

/// What the sensors of one arm say: differenced encoders and the wrist sensor, delays and noise
/// included.
struct ArmReading {
  JointVector q_rad;
  JointVector dq_rad_per_s;
  Wrench wrench_in_tool;       ///< force of the environment ON the tool, tool weight included
  double wrench_time_s = 0.0;  ///< when the wrist sensor took it
  /// How many commands were sent since the one that moved the arm in the millisecond before; 0
  /// where the drives obey at once.
  int command_age = 0;
  /// Torques that the drives measure of that millisecond, by the currents of their motors or by
  /// sensors in the joints; empty where they tell none.
  JointVector measured_torque_nm;
};

/// What both arms sense in one millisecond.
struct RobotReading {
  double time_s = 0.0;
  std::uint64_t tick = 0;  ///< grows by one each millisecond; a gap is a missed tick
  double rail_m = 0.0;     ///< the linear base, along its axis from its zero
  PerArm<ArmReading> arms;
};

/// What both arms are told in one millisecond.
struct RobotCommand {
  PerArm<JointVector> torque_nm;  ///< joint torques, gravity compensation included
  double rail_m = 0.0;            ///< where the position-controlled linear base should be
  PerArm<bool> brake = {};        ///< holding brakes on, drives off; the torques then count nothing
};

/// How the robot stands before a massage: on its linear base, the arms where the plan begins.
struct ReadyPose {
  PerArm<JointVector> q_rad;
  double rail_m = 0.0;
};

/// The interface to a two-armed torque-controlled robot, simulated or real. Its 1 kHz loop stands
/// in session/control_loop.hpp. `read`, `apply` and `fault` neither allocate nor throw.
///
/// Its drives must have a watchdog of their own, for whoever commands them may die. When no command
/// has come for 20 ms, 30 ms at most, they keep the torque that held the arm against gravity and
/// damp the joints. The brakes close after 300 ms, once the joints stand still, after 2 s in any
/// case: in the way of a person who comes they are a wall. An emergency stop does the same at once,
/// for good: a stop of category 1 [iec60204]. An arm without power is braked within 50 ms.
class Robot {
 public:
  virtual ~Robot() = default;
  /// Brings the robot to this pose by its own drives, away from anybody; blocks until it stands. A
  /// robot that stands already, because a massage was broken off and goes on, stays as it is. Fails
  /// with Fault::device when the pose is not reached.
  [[nodiscard]] virtual Result<void> stand_ready(const ReadyPose& pose) = 0;
  /// Waits for the next millisecond; nothing when the robot gave no reading in it.
  [[nodiscard]] virtual std::optional<RobotReading> read() noexcept = 0;
  /// Sends the command of this millisecond; never waits.
  virtual void apply(const RobotCommand& command) noexcept = 0;
  /// Null while all is well, else what the device says of itself, for people.
  [[nodiscard]] virtual const char* fault() const noexcept = 0;

 protected:
  Robot() = default;
  Robot(const Robot&) = default;
  Robot& operator=(const Robot&) = default;
};

}  // namespace tuina::robot
