// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/marks/bumps.hpp"

#include <doctest/doctest.h>

#include <array>
#include <utility>

#include "tests/marked_cloud.hpp"
#include "tests/reason.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/person.hpp"

using namespace tuina;

namespace {

std::vector<body::Bump> bumps_on(const PointCloud& cloud) {
  const auto back = body::fit_back(cloud);
  REQUIRE_MESSAGE(back.has_value(), test::reason(back));
  const auto bumps = body::find_bumps(cloud, *back);
  REQUIRE_MESSAGE(bumps.has_value(), test::reason(bumps));
  return *bumps;
}

}  // namespace

TEST_CASE("balls on the skin are found where they were stuck, and nothing else is") {
  const std::array<std::pair<const char*, BodyPosture>, 3> people = {
      {{"phantom:slim", BodyPosture::sitting},
       {"phantom:medium", BodyPosture::prone},
       {"phantom:hefty", BodyPosture::sitting}}};
  for (const auto& [kind, position] : people) {
    CAPTURE(kind);
    const auto person = sim::parse_person(kind, position, 5);
    REQUIRE(person);
    CHECK(bumps_on(test::marked_cloud(*person, {}, 1.5_mm, 1)).empty());
    std::vector<Vector3> places;
    for (std::size_t i = 0; i < seven_acupoints.size(); ++i)
      places.push_back(person->acupoints[i].at_in_couch);
    const auto bumps = bumps_on(test::marked_cloud(*person, places, 1.5_mm, 1));
    CHECK(bumps.size() == places.size());
    for (const Vector3& place : places) {
      double nearest_m = 1.0;
      for (const body::Bump& bump : bumps)
        nearest_m = std::min(nearest_m, (bump.at_in_couch - place).norm());
      CHECK(nearest_m < 3.0_mm);
    }
  }
}

TEST_CASE("a cloud too coarse to show a ball is refused, not found to be bare") {
  const auto person = sim::parse_person("phantom:medium", BodyPosture::sitting, 5);
  REQUIRE(person);
  const PointCloud fine = test::marked_cloud(*person, {}, 2_mm, 1);
  PointCloud cloud;
  for (std::size_t i = 0; i < fine.size(); i += 10) cloud.points.push_back(fine.points[i]);
  const auto back = body::fit_back(cloud);
  REQUIRE(back);
  const auto bumps = body::find_bumps(cloud, *back);
  REQUIRE_FALSE(bumps.has_value());
  CHECK(bumps.error().message.find("2.5 at most") != std::string::npos);
}
