// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/session.hpp"
#include "tuina/sim.hpp"

/// What the examples order for the person in a simulated world: the programme `lower_back`.
inline tuina::session::Order simulated_order(const tuina::sim::World& world) {
  return {.consent = {.answered_by = "the simulated person"},
          .programme = tuina::massage::load_programme("lower_back").value(),
          .plan_options = {},
          .atlas = tuina::body::read_atlas(TUINA_MODELS "/atlas.tuina").value(),
          .calibration = world.believed_calibration(),
          .robot = tuina::robot::load_robot("thesis").value(),
          .placed = {"thesis", world.person().position, world.believed_base_from_couch()},
          .commands = {}};
}
