// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/result.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::session {

/// Milliseconds without a reading after which a robot is given up; its drives brake by themselves
/// sooner (docs/safety.md).
inline constexpr int max_missed_readings = 10;

/// The one 1 kHz loop: read, step, apply, look. `step` turns a reading into the torques that the
/// guards have allowed, or into nothing to end; `look` sees what was applied and returns false to
/// end. Fails with Fault::device when the robot has a fault or gives no readings.
template <typename Step, typename Look>
[[nodiscard]] Result<void> run_control_loop(robot::Robot& robot, Step&& step, Look&& look) {
  int missed = 0;
  for (;;) {
    const std::optional<robot::RobotReading> reading = robot.read();
    if (const char* fault = robot.fault()) return fail(Fault::device, "the robot: {}", fault);
    if (!reading) {
      if (++missed < max_missed_readings) continue;
      return fail(Fault::device, "the robot has given no reading for {} ms", missed);
    }
    missed = 0;
    const std::optional<robot::RobotCommand> command = step(*reading);
    if (!command) return {};
    robot.apply(*command);
    if (!look(*reading, *command)) return {};
  }
}

}  // namespace tuina::session
