// SPDX-License-Identifier: Apache-2.0
// Drives and gears of the simulated robot.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "tuina/sim/robot/plant_world.hpp"

namespace tuina::sim {
namespace {

constexpr double untold_spread = 2.0;  // stiffness of gears that no table tells: a half to twice
constexpr double gear_damping_ratio = 0.05;
constexpr double joint_side_share = 0.1;  // of the rotor's inertia, seen at the joint
constexpr double waves_per_turn = 200.0;  // of the torque: twice in a turn of the motor, 100 : 1
constexpr double warm_s = 600.0;

}  // namespace

void Plant::World::soften_gears(ArmDevices& arm, const robot::ArmTable& table, Random& random) {
  if (options.flaws.gear_softness <= 0.0) return;
  const bool untold =
      std::any_of(table.links.begin(), table.links.begin() + arm.joints,
                  [](const robot::Link& link) { return link.gear_nm_per_rad <= 0.0; });
  // One maker's gears are alike.
  const double of_make = untold ? std::pow(untold_spread, uniform(random, -1.0, 1.0)) : 1.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k) {
    const double inertia = table.links[k].rotor_inertia_kg_m2;
    const double believed = robot::likely_gear_nm_per_rad(table.links[k]);
    if (believed >= robot::rigid_gear_nm_per_rad) continue;
    const double usual = table.links[k].gear_nm_per_rad > 0.0 ? believed : of_make * believed;
    const double spread = options.flaws.gear_spread;
    arm.gear_nm_per_rad[k] =
        usual * (1.0 + uniform(random, -spread, spread)) / options.flaws.gear_softness;
    arm.rotor_inertia[k] = (1.0 - joint_side_share) * inertia;
    arm.gear_damping[k] =
        2.0 * gear_damping_ratio * std::sqrt(arm.gear_nm_per_rad[k] * arm.rotor_inertia[k]);
    model->dof_armature[arm.dof[k]] = joint_side_share * inertia;
    // The motor holds the arm when it starts, so its gear is wound up already.
    arm.rotor_rad[k] =
        data->qpos[arm.dof[k]] + data->qfrc_bias[arm.dof[k]] / arm.gear_nm_per_rad[k];
  }
}

Shaft Plant::World::shaft(const ArmDevices& arm, std::size_t joint) const noexcept {
  const int dof = arm.dof[joint];
  if (arm.gear_nm_per_rad[joint] > 0.0)
    return {arm.rotor_rad[joint], arm.rotor_rad_per_s[joint], arm.rotor_inertia[joint]};
  return {data->qpos[dof], data->qvel[dof], data->qM[model->dof_Madr[dof]]};
}

/// Dahl's friction [dahl1968]: a gear winds up like a spring before it slips, so a resting arm
/// really sticks. Damping of the wound gear keeps it from ringing, as in [canudas1995].
double Plant::World::friction_of(ArmDevices& arm, std::size_t k, double speed) noexcept {
  if (arm.coulomb_nm[k] <= 0.0) return 0.0;
  double most = arm.coulomb_nm[k];
  if (options.flaws.friction_drift_share > 0.0) {
    const double load = std::abs(arm.torque_nm[k]) / arm.torque_limit_nm[k];
    const double warm = 1.0 - std::exp(-data->time / warm_s);
    most *= 1.0 + options.flaws.friction_drift_share * (load - warm);
  }
  const double spring = most / options.friction_windup_rad;
  const double wound = arm.friction_nm[k] / most * (speed > 0.0 ? 1.0 : -1.0);
  arm.friction_nm[k] =
      std::clamp(arm.friction_nm[k] + spring * speed * step_s * (1.0 - wound), -most, most);
  return std::clamp(arm.friction_nm[k] + arm.windup_damping[k] * speed, -most, most);
}

double Plant::World::through_gear_nm(const ArmDevices& arm, std::size_t k) const noexcept {
  const double wound_rad = arm.rotor_rad[k] - data->qpos[arm.dof[k]];
  const double play_rad = 0.5 * options.flaws.backlash_rad;
  if (std::abs(wound_rad) <= play_rad) return 0.0;
  return arm.gear_nm_per_rad[k] * (wound_rad - std::copysign(play_rad, wound_rad)) +
         arm.gear_damping[k] * (arm.rotor_rad_per_s[k] - data->qvel[arm.dof[k]]);
}

void Plant::World::drive(ArmDevices& arm) noexcept {
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k) {
    const Shaft now = shaft(arm, k);
    const double friction = friction_of(arm, k, now.rad_per_s);
    double motor = motor_nm(arm, k);
    flow(arm, k, arm.drive == Drive::braked ? 0.0 : motor);
    if (options.flaws.torque_ripple_share > 0.0)
      motor *= 1.0 + options.flaws.torque_ripple_share * std::sin(waves_per_turn * now.rad);
    const double left_nm = motor - friction - arm.viscous[k] * now.rad_per_s;
    if (arm.gear_nm_per_rad[k] <= 0.0) {
      data->qfrc_applied[arm.dof[k]] += left_nm;
      continue;
    }
    const double through_nm = through_gear_nm(arm, k);
    data->qfrc_applied[arm.dof[k]] += through_nm;
    arm.rotor_rad_per_s[k] += step_s / arm.rotor_inertia[k] * (left_nm - through_nm);
    arm.rotor_rad[k] += step_s * arm.rotor_rad_per_s[k];
  }
  arm.current_known = true;
}

}  // namespace tuina::sim
