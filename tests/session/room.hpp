// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "tuina/session/run.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::session {

/// A phantom who lies, the robot of the thesis over it, and what a massage of its loins needs.
struct Room {
  sim::WorldOptions options = {};
  sim::Person person = sim::parse_person("phantom:medium", BodyPosture::prone, 3).value();
  std::unique_ptr<sim::World> world =
      sim::World::make(person,
                       robot::place_robot(robot::load_robot("thesis").value(), person.position),
                       options, 3)
          .value();
  Order order = {.consent = {.answered_by = "the simulated person"},
                 .programme = massage::load_programme("lower_back").value(),
                 .plan_options = {},
                 .atlas = body::read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina").value(),
                 .calibration = world->believed_calibration(),
                 .robot = robot::load_robot("thesis").value(),
                 .placed = {"thesis", person.position, world->believed_base_from_couch()},
                 .commands = {}};
  Observers nobody{{}};

  Result<Session> run_with(robot::Robot& robot) {
    return session::run({world->camera(), world->turntable(), robot}, order, {}, nobody);
  }
  /// A massage by its own robot that somebody looks at.
  Result<Session> run_before(Observer& observer) {
    return session::run({world->camera(), world->turntable(), world->robot()}, order, {}, observer);
  }
};

}  // namespace tuina::session
