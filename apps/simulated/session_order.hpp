// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/cli/command_line.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/session/run.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

using record::SessionOrder;

/// What the scanner looks at, and the world, that a config's section `simulation` describes.
[[nodiscard]] sim::ScanFlaws scan_flaws(const session::Config& config);
[[nodiscard]] sim::WorldOptions world_options(const session::Config& config);
/// The arm as it is believed to be: gears that do not give way here are not believed to.
[[nodiscard]] robot::ArmTable believed_gears(robot::ArmTable arm, const sim::DeviceFlaws& flaws);

/// A simulated world, and what the session in it is told.
struct SimulatedRoom {
  std::unique_ptr<sim::World> world;
  session::Order order;
  std::string consent_toml;  ///< answers as they were given
};
/// Reads all that an order names. Nobody is scanned before the health questions are answered.
/// `devices` are the robot's sensors and drives, but for their flaws, which the config has.
[[nodiscard]] Result<SimulatedRoom> make_room(const SessionOrder& order,
                                              const session::Config& config,
                                              const CommonOptions& common,
                                              const sim::PlantOptions& devices = {});
/// What a session is told whose scanner and arms are real.
struct DeviceRoom {
  session::Order order;
  robot::RobotPlacement placement;
  std::string consent_toml;  ///< answers as they were given
};
/// Reads all that an order names. Nothing is assumed of a person who is not simulated: fails with
/// Fault::usage where the answers to the health questions, the scanner's calibration or the place
/// of the robot are not given.
[[nodiscard]] Result<DeviceRoom> make_device_room(const SessionOrder& order,
                                                  const session::Config& config);
/// What two programs must have in common that simulate parts of one session: person, seed, robot.
[[nodiscard]] std::string world_name(const SessionOrder& order, const sim::World& world,
                                     std::uint64_t seed);

}  // namespace tuina::app
