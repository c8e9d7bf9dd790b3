// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <doctest/doctest.h>

#include "tuina/motion/free_path.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::test {

/// A programme made ready for a person, on a robot whose shoulders stand so much nearer together.
inline motion::ReadyPlan ready_for(const char* who, BodyPosture position, const char* what,
                                   std::uint64_t seed, const char* robot = "thesis",
                                   double shoulders_nearer_m = 0.0) {
  const auto person = sim::parse_person(who, position, seed);
  REQUIRE(person.has_value());
  PointCloud skin_in_couch;
  skin_in_couch.points = person->skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch, {.position = position});
  REQUIRE(back.has_value());
  const auto programme = massage::load_programme(what);
  REQUIRE(programme.has_value());
  auto plan = massage::plan(*back, person->acupoints, person->landmarks, *programme);
  REQUIRE(plan.has_value());
  robot::RobotPlacement placement = robot::place_robot(robot::load_robot(robot).value(), position);
  robot::RobotMount& mount = placement.mount;
  mount.base_from_shoulder[Arm::left].translation().y() -= 0.5 * shoulders_nearer_m;
  mount.base_from_shoulder[Arm::right].translation().y() += 0.5 * shoulders_nearer_m;
  const auto models = robot::both_models(placement.arm, mount);
  auto ready =
      motion::make_ready(std::move(*plan), *back, mount, models, mount.base_from_couch, 40e-3);
  REQUIRE(ready.has_value());
  for (const Arm arm : both_arms) {
    const Transform tool = models[arm].base_from_tool(ready->ready_rad[arm], ready->rail_m);
    const Vector3 tip = control::tip_pose(tool, models[arm].table().tool_radius_m).at_in_base;
    // A tool that waits keeps off the person, wherever the base stands.
    CHECK(motion::height_above_skin_m(*back, mount.base_from_couch.inverse() * tip) >= 40e-3);
  }
  return std::move(*ready);
}

}  // namespace tuina::test
