// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/arm_watch.hpp"

namespace tuina::safety {

/// An arm like that of the thesis: at zero the upper arm hangs down and the forearm points ahead.
inline robot::ArmTable six_joint_arm() {
  const auto link = [](double offset_deg, double d_m, double a_m, double alpha_deg, double mass_kg,
                       const std::array<double, 3>& com_m, double inertia_kg_m2, double rotor_kg_m2,
                       double coulomb_nm, double limit_nm) {
    return robot::Link{.offset_rad = from_deg(offset_deg),
                       .d_m = d_m,
                       .a_m = a_m,
                       .alpha_rad = from_deg(alpha_deg),
                       .mass_kg = mass_kg,
                       .com_in_joint = com_m,
                       .inertia_kg_m2 = {inertia_kg_m2, inertia_kg_m2, inertia_kg_m2},
                       .rotor_inertia_kg_m2 = rotor_kg_m2,
                       .coulomb_nm = coulomb_nm,
                       .viscous_nm_s_per_rad = 0.08 * coulomb_nm,
                       .torque_limit_nm = limit_nm,
                       .radius_m = 0.05};
  };
  robot::ArmTable table;
  table.joints = 6;
  table.links[0] = link(0, 0, 0, 90, 1.15, {0, 0, 0}, 1e-3, 0.15, 2.5, 120);
  table.links[1] = link(-90, 0, 0, 90, 1.15, {0, 0, 0}, 1e-3, 0.15, 2.5, 120);
  table.links[2] = link(-90, -0.3, 0, 90, 3.3, {0, 0, -0.15}, 2e-2, 0.1, 1.5, 70);
  table.links[3] = link(-90, 0, 0, 90, 1.1, {0, 0.075, 0}, 2e-3, 0.1, 1.5, 70);
  table.links[4] = link(-180, -0.3, 0, 90, 1.1, {0, 0, -0.225}, 2e-3, 0.03, 0.5, 20);
  table.links[5] = link(-90, 0, 0.1, 0, 0.5, {0.06, 0, 0}, 5e-4, 0.03, 0.5, 20);
  table.tool_mass_kg = 0.4;
  return table;
}

/// Two of them side by side, so far from shoulder to shoulder; x ahead, y to the left, z up.
inline PerArm<robot::ArmModel> two_arms(double apart_m = 0.4,
                                        const robot::ArmTable& table = six_joint_arm()) {
  robot::RobotMount mount;
  Matrix3 turn;
  turn << 0, 1, 0, 0, 0, -1, -1, 0, 0;  // x of the shoulder down, its z to the right
  mount.base_from_shoulder[Arm::left].linear() = turn;
  mount.base_from_shoulder[Arm::right].linear() = turn;
  mount.base_from_shoulder[Arm::left].translation().y() = 0.5 * apart_m;
  mount.base_from_shoulder[Arm::right].translation().y() = -0.5 * apart_m;
  return robot::both_models(table, mount);
}

inline JointVector bent() {
  JointVector q_rad(6);
  q_rad << 0.5, 0.1, 0.2, 0.4, -0.3, 0.4;
  return q_rad;
}

/// What the wrist sensor of an arm says that is pushed with that force: the tool's weight, too.
inline Wrench wrist_of(const robot::ArmModel& model, const JointVector& q_rad,
                       const Vector3& force_in_base_n) {
  const Vector3 weight_n(0.0, 0.0, -0.4 * 9.81);
  const Matrix3 turn = model.base_from_tool(q_rad, 0.0).linear();
  return {.force_n = turn.transpose() * (force_in_base_n + weight_n)};
}

/// An arm that stands, watched; `pushed_n` is felt at its tool.
struct Standing {
  robot::ArmModel model;
  ArmWatch watch{model};
  robot::RobotReading reading;
  Vector3 pushed_n = Vector3::Zero();
  JointVector extra_nm = JointVector::Zero(6);  ///< beyond what holds the arm
  double stiffness_n_per_m = 0.0;               ///< of the controller; 0: a hand leads the arm

  explicit Standing(const robot::ArmTable& table = six_joint_arm())
      : model(two_arms(0.4, table)[Arm::left]) {
    reading.arms[Arm::left].q_rad = bent();
    reading.arms[Arm::left].dq_rad_per_s = JointVector::Zero(6);
  }
  robot::ArmReading& arm() { return reading.arms[Arm::left]; }
  Observation observe(Phase phase = Phase::free) {
    arm().wrench_in_tool = wrist_of(model, arm().q_rad, pushed_n);
    return look(phase);
  }
  /// As it is in the reading.
  Observation look(Phase phase = Phase::free) {
    reading.tick += 1;
    reading.time_s += 1e-3;
    arm().wrench_time_s = reading.time_s - 1e-3;
    const auto dynamics = model.evaluate(arm().q_rad, JointVector::Zero(6), 0.0);
    const JointVector held_nm =
        dynamics.gravity_nm - dynamics.jacobian.topRows<3>().transpose() * pushed_n + extra_nm;
    return watch.observe(reading, Arm::left,
                         {.phase = phase, .stiffness_n_per_m = stiffness_n_per_m}, held_nm);
  }
  Observation observe_for(int ticks, Phase phase = Phase::free) {
    Observation seen;
    for (int i = 0; i < ticks; ++i) seen = observe(phase);
    return seen;
  }
};

}  // namespace tuina::safety
