// SPDX-License-Identifier: Apache-2.0
// Brakes of the simulated robot, and what its drives do when nobody commands them.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "tuina/sim/robot/plant_world.hpp"

namespace tuina::sim {
namespace {

// A holding brake is dry friction that gives way like a stiff spring before it slips. It holds
// twice what its drive can give, as such brakes are sized; its spring lets the joint ring at 80 Hz,
// a third of what the step of the physics bears.
constexpr double brake_share = 2.0;
constexpr double brake_rate_per_s = 500.0, brake_damping_ratio = 0.7;

// Drives without commands take the speed out of a joint within 40 ms: at the tool this is about
// 100 N s/m, against which a person who sits up pushes it aside.
constexpr double damped_rate_per_s = 25.0;
constexpr int min_damped_ticks = 300, max_damped_ticks = 2000;
constexpr double still_rad_per_s = 0.05;
constexpr int brakes_close_ticks = 50;  // without power

}  // namespace

void Plant::emergency_stop() noexcept {
  for (ArmDevices& arm : world_->arms.of) arm.stopped = true;
}

void Plant::World::choose_drive(ArmDevices& arm) noexcept {
  const bool unheard = options.watchdog_ticks > 0 && unanswered >= options.watchdog_ticks;
  const bool alone = arm.stopped || unheard;
  arm.damped_ticks = alone ? arm.damped_ticks + 1 : 0;
  arm.unpowered_ticks = arm.powered ? 0 : arm.unpowered_ticks + 1;
  const bool rests = arm.damped_ticks > min_damped_ticks && stands_still(arm);
  if (rests || arm.damped_ticks > max_damped_ticks) arm.caught = true;
  const Drive before = arm.drive;
  if (!arm.powered) {
    arm.drive = arm.caught || arm.unpowered_ticks > brakes_close_ticks ? Drive::braked : Drive::off;
  } else if (arm.caught || arm.brake_wanted) {
    arm.drive = Drive::braked;
  } else {
    arm.drive = alone ? Drive::damped : Drive::commanded;
  }
  if (arm.drive != Drive::braked || before == Drive::braked) return;
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k)
    arm.braked_at_rad[k] = shaft(arm, k).rad;
}

/// Nobody pushes its joints on.
bool Plant::World::stands_still(const ArmDevices& arm) const noexcept {
  bool still = true;
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k)
    still = still && std::abs(shaft(arm, k).rad_per_s) < still_rad_per_s;
  return still;
}

double Plant::World::motor_nm(ArmDevices& arm, std::size_t joint) const noexcept {
  switch (arm.drive) {
    case Drive::commanded:
      return arm.torque_nm[joint];
    case Drive::damped: {
      const double inertia = data->qM[model->dof_Madr[arm.dof[joint]]] + arm.rotor_inertia[joint];
      const double damping = damped_rate_per_s * inertia;
      const double limit_nm = arm.torque_limit_nm[joint];
      return std::clamp(arm.gravity_nm[joint] - damping * shaft(arm, joint).rad_per_s, -limit_nm,
                        limit_nm);
    }
    case Drive::off:
      return 0.0;
    case Drive::braked:
      return brake_nm(arm, joint);
  }
  return 0.0;
}

double Plant::World::brake_nm(ArmDevices& arm, std::size_t joint) const noexcept {
  const auto [at_rad, rad_per_s, inertia] = shaft(arm, joint);
  const double spring = inertia * brake_rate_per_s * brake_rate_per_s;
  const double max_nm = brake_share * arm.torque_limit_nm[joint];
  const double wound_nm = std::clamp(spring * (arm.braked_at_rad[joint] - at_rad), -max_nm, max_nm);
  arm.braked_at_rad[joint] = at_rad + wound_nm / spring;  // beyond that it slips
  const double damping = 2.0 * brake_damping_ratio * inertia * brake_rate_per_s;
  return std::clamp(wound_nm - damping * rad_per_s, -max_nm, max_nm);
}

}  // namespace tuina::sim
