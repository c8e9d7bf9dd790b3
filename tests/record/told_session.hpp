// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/session/observer.hpp"

namespace tuina::test {

/// Scan, map and a plan of one press, told in the order of a session.
inline void tell_beginning(session::Observer& observer) {
  scanner::Scan scan;
  scan.cloud_in_couch.points = {Vector3(0.1, 0.2, 0.5)};
  observer.on_scan(scan);
  observer.on_map({.acupoints = {{"SI11_L", Vector3(0.1, 0.1, 0.5), Vector3::UnitY(), 5e-3},
                                 {"GV4", Vector3(0.0, 0.1, 0.3), Vector3::UnitY(), 5e-3}}});
  motion::ReadyPlan ready;
  ready.plan.programme = "one press";
  auto& path = ready.plan.paths.emplace_back().path;
  path.name = "press GV4";
  path.points = {{.at_in_couch = Vector3(0.0, 0.1, 0.3)}};
  observer.on_plan(ready, Transform::Identity());
}

/// A millisecond of arms that wave and feel.
inline session::Tick tick_at(std::uint64_t ms) {
  session::Tick tick;
  tick.reading.tick = ms;
  tick.reading.time_s = 1e-3 * static_cast<double>(ms);
  for (const Arm arm : both_arms) {
    const double phase = tick.reading.time_s + (arm == Arm::left ? 0.0 : 1.0);
    tick.reading.arms[arm].q_rad = JointVector::Constant(6, 0.5 * std::sin(phase));
    tick.reading.arms[arm].dq_rad_per_s = JointVector::Constant(6, 0.5 * std::cos(phase));
    tick.reading.arms[arm].wrench_in_tool.force_n = Vector3(-20.0 * std::sin(phase), 0.1, 0.0);
    tick.verdict.command.torque_nm[arm] = JointVector::Constant(6, 3.0 * std::cos(phase));
  }
  return tick;
}

}  // namespace tuina::test
