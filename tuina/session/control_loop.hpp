// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/result.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/robot_guard.hpp"

namespace tuina::session {

/// Milliseconds without a reading after which a robot is given up; its drives brake by themselves
/// sooner (docs/safety.md).
inline constexpr int max_missed_readings = 10;

/// The one 1 kHz loop: read, propose, judge, apply, look. `propose` turns a reading into what a
/// controller wants, or into nothing to end; `guard` makes of it what the robot does; `look` sees
/// both and returns false to end. `guard` is a RobotGuard or a Supervisor. Fails with Fault::device
/// when the robot has a fault or gives no readings.
template <typename Guard, typename Propose, typename Look>
[[nodiscard]] Result<void> run_control_loop(robot::Robot& robot, Guard& guard, Propose&& propose,
                                            Look&& look) {
  int missed = 0;
  for (;;) {
    const std::optional<robot::RobotReading> reading = robot.read();
    if (const char* fault = robot.fault()) return fail(Fault::device, "the robot: {}", fault);
    if (!reading) {
      if (++missed < max_missed_readings) continue;
      return fail(Fault::device, "the robot has given no reading for {} ms", missed);
    }
    missed = 0;
    const std::optional<safety::RobotProposal> proposal = propose(*reading);
    if (!proposal) return {};
    const safety::RobotVerdict verdict = guard.check(*reading, *proposal);
    robot.apply(verdict.command);
    if (!look(*reading, verdict)) return {};
  }
}

}  // namespace tuina::session
