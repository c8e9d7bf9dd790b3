// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "tuina/session/run.hpp"
#include "tuina/sim/world.hpp"
#include "tuina/tissue/body_condition.hpp"

namespace tuina::app {

/// What somebody at a terminal orders of a simulated session: names and files.
struct SessionOrder {
  std::string person = "phantom:medium";
  std::optional<BodyPosture> position;
  std::string programme = "relax";
  std::string robot = "thesis";  ///< a shipped robot or the file of its table
  body::Method method = body::Method::surface;
  std::string atlas;       ///< a file or a labelled body; empty: the shipped one
  std::string no_go;       ///< a file with what the therapist rules out; empty: nothing
  std::string consent;     ///< a file with answers; empty: the simulated person answers
  std::string robot_pose;  ///< a file of `calibrate --robot`; empty: as good a one
  bool adaptive = true;
  tissue::BodyFacts facts;
  bool keys = false;  ///< live commands from standard input
  /// Commands as they were given in a session before, and when; instead of keys.
  std::vector<std::pair<double, session::LiveCommand>> commands;
  bool real_time = false;
  bool processes = false;  ///< guard and robot are processes of their own
  std::string link;        ///< name of the memory that they share; empty: one of this process
};

/// How the config and the therapist want a plan.
[[nodiscard]] Result<massage::PlanOptions> plan_options(const session::Config& config,
                                                        const std::string& no_go_file);

/// The world that a config's section `simulation` describes.
[[nodiscard]] sim::WorldOptions world_options(const session::Config& config);

/// A simulated world, and what the session in it is told.
struct SimulatedRoom {
  std::unique_ptr<sim::World> world;
  session::Order order;
  std::string consent_toml;  ///< answers as they were given
};
/// Reads all that an order names. Nobody is scanned before the health questions are answered.
[[nodiscard]] Result<SimulatedRoom> make_room(const SessionOrder& order,
                                              const session::Config& config,
                                              const CommonOptions& common);

}  // namespace tuina::app
