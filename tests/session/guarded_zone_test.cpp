// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/guarded_zone.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/massage/backs.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/session/guarded_field.hpp"

using namespace tuina;

TEST_CASE("in every zone the plan may ask for what the guard lets through, and both trip alike") {
  for (std::size_t i = 0; i < massage::zone_rules.size(); ++i) {
    const auto zone = static_cast<massage::Zone>(i);
    CAPTURE(massage::name_of(zone));
    const safety::ForceLimits limits = safety::ceiling_of(session::guarded_zone(zone));
    CHECK(massage::rule_of(zone).cap_n == limits.set_n);
    CHECK(massage::rule_of(zone).trip_n == limits.trip_n);
  }
}

TEST_CASE("no zone of a person has the ceilings of the bench") {
  for (std::size_t i = 0; i < massage::zone_rules.size(); ++i) {
    CHECK(session::guarded_zone(static_cast<massage::Zone>(i)) != safety::Zone::bench);
  }
}

TEST_CASE("a massage and a hand that teaches ask the one table for the guard's zone") {
  int tables = 0;
  const std::filesystem::path sources = TUINA_SOURCE_DIR;
  for (const char* folder : {"tuina", "apps"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(sources / folder)) {
      if (!entry.is_regular_file()) continue;
      const auto text = read_file(entry.path().string());
      REQUIRE(text.has_value());
      tables += text->find("Zone guarded_zone(") != std::string::npos;
    }
  }
  CHECK(tables == 1);
}

TEST_CASE(
    "wherever a plan goes the guard's map of the back bears it, however unsure the points are") {
  const body::BackSurface back = test::wall();
  const auto landmarks = test::landmarks_of_a_man();
  const auto programme = massage::load_programme("lower_back");
  REQUIRE(programme.has_value());
  int strokes = 0;
  for (double unsure_m = 0.0; unsure_m < 0.09; unsure_m += 2.5e-3) {
    CAPTURE(unsure_m);
    auto points = test::seven_points(back, 0.5 * unsure_m);
    points.back().uncertainty_m = unsure_m;  // GV4, which says where the midline is
    for (const Acupoint& inner : test::inner_points(back, 8e-3)) points.push_back(inner);
    const auto plan = massage::plan(back, points, landmarks, *programme);
    REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
    const auto field = session::zone_field(back, points, landmarks, {}, Transform::Identity());
    REQUIRE(field.has_value());
    const safety::ZoneField guarded = field->reaching(15e-3);  // as RobotGuard does
    for (const massage::PlannedPath& path : plan->paths) {
      strokes += path.path.technique == Technique::stroke;
      for (const ContactPoint& point : path.path.points) {
        const auto* cell = guarded.at(point.at_in_couch);
        REQUIRE(cell != nullptr);
        CAPTURE(path.path.name);
        REQUIRE(point.force_n <= safety::ceiling_of(cell->zone).set_n);
      }
    }
  }
  CHECK(strokes > 40);
}

TEST_CASE("the guard's map reaches past the rim of the scan, and not far") {
  const body::BackSurface back = test::wall();
  const auto field = session::zone_field(back, test::seven_points(back, 0.0),
                                         test::landmarks_of_a_man(), {}, Transform::Identity());
  REQUIRE(field.has_value());
  const auto rim = std::ranges::max_element(
      back.points().points, {}, [&](const Vector3& at) { return at.dot(field->along_in_base); });
  const auto beyond = [&](double m) { return field->at(*rim + m * field->along_in_base); };
  REQUIRE(beyond(0.0) != nullptr);
  REQUIRE(beyond(15e-3) != nullptr);
  CHECK(beyond(15e-3)->zone == beyond(0.0)->zone);
  CHECK(beyond(30e-3) == nullptr);
}
