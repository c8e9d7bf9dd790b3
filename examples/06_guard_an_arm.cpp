// SPDX-License-Identifier: Apache-2.0
// The guard has the last word. A controller holds an arm for half a second, then goes mad and asks
// for full torque of the shoulder. The guard knows nothing of that controller: it sees a tool too
// fast, takes the arm over, and stays there until somebody resets it.
#include <fmt/core.h>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/safety/guard.hpp"
#include "tuina/sim/robot/plant.hpp"

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

  safety::Guard::Options options;
  options.torque_limit_nm.resize(table.joints);
  for (int i = 0; i < table.joints; ++i) {
    options.torque_limit_nm[i] = table.links[static_cast<std::size_t>(i)].torque_limit_nm;
  }
  safety::Guard guard(options);

  double max_speed_m_per_s = 0.0, stopped_s = -1.0;
  for (int tick = 0; tick < 1500; ++tick) {
    const robot::RobotReading reading = *(*robot)->read();
    const robot::ArmReading& arm = reading.arms[Arm::left];
    const auto dynamics = left.evaluate(arm.q_rad, arm.dq_rad_per_s, reading.rail_m);
    const Vector3 velocity_m_per_s = dynamics.jacobian.topRows<3>() * arm.dq_rad_per_s;
    max_speed_m_per_s = std::max(max_speed_m_per_s, velocity_m_per_s.norm());

    // The controller: a spring at each joint, until it is not.
    JointVector torque_nm = dynamics.gravity_nm;
    torque_nm += 200.0 * (ready_rad[Arm::left] - arm.q_rad) - 10.0 * arm.dq_rad_per_s;
    if (reading.time_s > 0.5) torque_nm[0] = options.torque_limit_nm[0];

    const safety::Verdict verdict = guard.check(
        {.tick = reading.tick,
         .time_s = reading.time_s,
         .wrench_time_s = arm.wrench_time_s,
         .q_rad = arm.q_rad,
         .dq_rad_per_s = arm.dq_rad_per_s,
         .tool_in_base = dynamics.base_from_tool.translation(),
         .tool_velocity_m_per_s = velocity_m_per_s,
         .jacobian = dynamics.jacobian.topRows<3>(),
         .gravity_nm = dynamics.gravity_nm},
        {.torque_nm = torque_nm, .virtual_target_in_base = dynamics.base_from_tool.translation()});
    (*robot)->apply({.torque_nm = {.of = {verdict.allowed_nm,
                                          right.gravity_nm(reading.arms[Arm::right].q_rad)}}});
    if (verdict.latched && stopped_s < 0.0) {
      stopped_s = reading.time_s;
      fmt::print("{:.3f} s: {} after {}\n", stopped_s, safety::name_of(verdict.action),
                 safety::name_of(verdict.cause));
    }
  }
  const double speed_m_per_s = (*robot)->truth().arms[Arm::left].velocity_in_couch.norm();
  fmt::print("the tool reached {:.2f} m/s and now moves at {:.3f} m/s\n", max_speed_m_per_s,
             speed_m_per_s);
  return stopped_s > 0.5 && speed_m_per_s < 0.02 ? 0 : 1;
}
