// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "tests/safety/two_arms.hpp"
#include "tuina/safety/robot_guard.hpp"

namespace tuina::safety {

/// Two arms that stand, each felt with a force at its tool, and a controller that holds them.
struct StandingRobot {
  PerArm<robot::ArmModel> models;
  RobotGuard guard;
  robot::RobotReading reading;
  RobotProposal proposal;
  RobotVerdict verdict;
  PerArm<Vector3> felt_n = {.of = {Vector3::Zero(), Vector3::Zero()}};
  Vector3 wild_n = Vector3::Zero();  ///< that the left wrist says besides

  explicit StandingRobot(const RobotGuard::Options& options = {}, double apart_m = 0.4)
      : models(two_arms(apart_m)), guard(models, options) {
    reading.rail_m = proposal.rail_m = 0.1;
    for (const Arm arm : both_arms)
      reading.arms[arm] = {.q_rad = JointVector::Zero(6), .dq_rad_per_s = JointVector::Zero(6)};
  }
  [[nodiscard]] JointVector held_nm(Arm arm) const {
    const auto dynamics =
        models[arm].evaluate(JointVector::Zero(6), JointVector::Zero(6), reading.rail_m);
    return dynamics.gravity_nm - dynamics.jacobian.topRows<3>().transpose() * felt_n[arm];
  }
  /// Says of an arm that it presses on a back before it, with what is felt.
  void press(Arm arm, double force_n, Zone zone = Zone::muscle) {
    proposal.arms[arm].phase = Phase::contact;
    proposal.arms[arm].zone = zone;
    proposal.arms[arm].set_force_n = force_n;
    proposal.arms[arm].normal_in_base = -Vector3::UnitX();
    felt_n[arm] = -force_n * Vector3::UnitX();
  }
  const RobotVerdict& tick(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      reading.tick += 1;
      reading.time_s += 1e-3;
      for (const Arm arm : both_arms) {
        Vector3 noise_n(1e-9 * static_cast<double>(reading.tick % 2), 0.0, 0.0);
        if (arm == Arm::left) noise_n += wild_n;
        reading.arms[arm].wrench_time_s = reading.time_s - 1e-3;
        if (reading.arms[arm].q_rad.size() == 6)
          reading.arms[arm].wrench_in_tool =
              wrist_of(models[arm], reading.arms[arm].q_rad, felt_n[arm] + noise_n);
        proposal.arms[arm].torque_nm = held_nm(arm);
      }
      verdict = guard.check(reading, proposal);
    }
    return verdict;
  }
  [[nodiscard]] Action action(Arm arm) const { return verdict.arms[arm].action; }
  [[nodiscard]] Cause cause(Arm arm) const { return verdict.arms[arm].cause; }
};

}  // namespace tuina::safety
