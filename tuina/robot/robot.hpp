// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/core/arm.hpp"

namespace tuina::robot {

/// What the sensors of one arm say: differenced encoders and the wrist sensor, delays and noise
/// included.
struct ArmReading {
  JointVector q_rad;
  JointVector dq_rad_per_s;
  Wrench wrench_in_tool;       ///< force of the environment ON the tool, tool weight included
  double wrench_time_s = 0.0;  ///< when the wrist sensor took it
};

struct RobotReading {
  double time_s = 0.0;
  std::uint64_t tick = 0;  ///< grows by one each millisecond; a gap is a missed tick
  double rail_m = 0.0;     ///< the linear base, along its axis from its zero
  PerArm<ArmReading> arms;
};

struct RobotCommand {
  PerArm<JointVector> torque_nm;  ///< joint torques, gravity compensation included
  double rail_m = 0.0;            ///< where the position-controlled linear base should be
};

/// The door to a two-armed torque-controlled robot, simulated or real. The 1 kHz loop is
/// `reading = robot.read(); ...; robot.apply(command);` and neither call allocates or throws.
class Robot {
 public:
  virtual ~Robot() = default;
  /// Waits for the next millisecond.
  [[nodiscard]] virtual RobotReading read() noexcept = 0;
  virtual void apply(const RobotCommand& command) noexcept = 0;
  /// Null while all is well, else what the device says of itself, for people.
  [[nodiscard]] virtual const char* fault() const noexcept = 0;

 protected:
  Robot() = default;
  Robot(const Robot&) = default;
  Robot& operator=(const Robot&) = default;
};

}  // namespace tuina::robot
