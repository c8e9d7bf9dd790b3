// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "tuina/hardware/position_robot.hpp"
#include "tuina/session/config.hpp"
#include "tuina/sim/robot/plant.hpp"
#include "tuina/sim/robot/position_plant.hpp"

namespace tuina::app {

/// What the arms of a session take, where that is no torques.
[[nodiscard]] inline std::optional<sim::PositionLoop> loop_of(const session::Config& config) {
  if (config.simulation.arms == "position_500") return sim::quick_loop;
  if (config.simulation.arms == "position_125") return sim::slow_loop;
  return std::nullopt;
}

/// Gears and encoders of an arm that takes places are its maker's to mind.
inline void as_within_a_loop(sim::PlantOptions& devices) {
  devices.encoder_counts = devices.velocity_low_pass_hz = 0.0;
  devices.flaws.gear_softness = devices.flaws.backlash_rad = 0.0;
}

/// Known to a fifth.
[[nodiscard]] inline double believed_lag_s(const sim::PositionLoop& loop, std::uint64_t seed) {
  return (seed % 2 == 0 ? 1.2 : 0.8) * loop.lag_s();
}

/// Arms that take places, as a robot that takes torques.
struct PlacedArms {
  PlacedArms(robot::Robot& torques, const PerArm<robot::ArmModel>& models,
             const sim::PositionLoop& loop, std::uint64_t seed)
      : drives(torques, models, loop),
        robot(drives, models, {.lag_s = believed_lag_s(loop, seed)}) {}
  sim::PositionPlant drives;
  hardware::PositionRobot robot;
};

}  // namespace tuina::app
