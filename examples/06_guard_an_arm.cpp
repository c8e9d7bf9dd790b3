// SPDX-License-Identifier: Apache-2.0
// The guard has the last word. A controller holds an arm for half a second, then goes mad and asks
// for full torque of the shoulder. The guard knows nothing of that controller: it sees a tool too
// fast, takes the arm over, and stays there until somebody resets it.
#include <fmt/core.h>

#include "tuina/robot.hpp"
#include "tuina/safety.hpp"
#include "tuina/sim.hpp"

using namespace tuina;

int main() {
  const auto mount = robot::mount_for(BodyPosture::sitting);
  const robot::ArmTable table = robot::thesis_arm();
  const auto ready_rad = robot::ready_posture(table, mount);
  const robot::ArmModel left(table, mount, Arm::left), right(table, mount, Arm::right);
  auto robot = sim::Plant::make(mount, {.of = {table, table}}, {.q_rad = ready_rad}, nullptr);
  if (!robot) {
    fmt::print(stderr, "{}\n", robot.error().message);
    return 1;
  }

  safety::RobotGuard guard({.of = {left, right}}, {});

  double max_speed_m_per_s = 0.0, stopped_s = -1.0;
  for (int tick = 0; tick < 1500; ++tick) {
    const robot::RobotReading reading = *(*robot)->read();
    // The controller: a spring at each joint, until it is not.
    safety::RobotProposal wanted;
    for (const Arm side : both_arms) {
      const robot::ArmReading& arm = reading.arms[side];
      wanted.arms[side].torque_nm = (side == Arm::left ? left : right).gravity_nm(arm.q_rad) +
                                    200.0 * (ready_rad[side] - arm.q_rad) - 10.0 * arm.dq_rad_per_s;
    }
    if (reading.time_s > 0.5)
      wanted.arms[Arm::left].torque_nm[0] = table.links.front().torque_limit_nm;

    const safety::RobotVerdict verdict = guard.check(reading, wanted);
    (*robot)->apply(verdict.command);
    max_speed_m_per_s =
        std::max(max_speed_m_per_s, (*robot)->truth().arms[Arm::left].velocity_in_couch.norm());
    const safety::Verdict& of_left = verdict.arms[Arm::left];
    if (of_left.latched && stopped_s < 0.0) {
      stopped_s = reading.time_s;
      fmt::print("{:.3f} s: {} after {}\n", stopped_s, safety::name_of(of_left.action),
                 safety::name_of(of_left.cause));
    }
  }
  const double speed_m_per_s = (*robot)->truth().arms[Arm::left].velocity_in_couch.norm();
  fmt::print("the tool reached {:.2f} m/s and now moves at {:.3f} m/s\n", max_speed_m_per_s,
             speed_m_per_s);
  return stopped_s > 0.5 && speed_m_per_s < 0.02 ? 0 : 1;
}
