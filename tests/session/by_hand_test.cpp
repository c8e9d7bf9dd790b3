// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/earlier/by_hand.hpp"

#include <doctest/doctest.h>

#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::session;

namespace {

std::vector<Acupoint> points_of_a_back() {
  std::vector<Acupoint> points;
  const Vector3 places[] = {
      {0.08, 0.01, 0.50}, {-0.08, 0.0, 0.50}, {0.06, 0.0, 0.4}, {-0.06, 0.02, 0.4}, {0, 0, 0.25}};
  for (const char* name : {"SI11_L", "SI11_R", "BL47_L", "BL47_R", "GV4"})
    points.push_back({.name = name, .at_in_couch = places[points.size()]});
  return points;
}

const ByHand said = {.no_go = {{"wound", {{0, 0, 0.3}, {0.05, 0, 0.3}, {0.05, 0, 0.35}}}},
                     .fixed = {{.name = "GV4", .at_in_couch = {0, 0.01, 0.26}}}};

}  // namespace

TEST_CASE("what was said by hand moves with the person") {
  const std::vector<Acupoint> then = points_of_a_back();
  const Transform motion = Eigen::Translation3d(0.04, -0.02, 0.03) *
                           Eigen::AngleAxisd(0.2, Vector3(0.3, 1.0, 0.2).normalized());
  std::vector<Acupoint> now = then;
  for (Acupoint& point : now) point.at_in_couch = motion * point.at_in_couch;
  // Points that only one scan has, and another order of them, change nothing.
  std::swap(now.front(), now.back());
  now.push_back({.name = "GV14", .at_in_couch = {9, 9, 9}});

  const auto moved = carried({said, then}, now, max_moved_misfit_m);
  REQUIRE(moved.has_value());
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 wanted = motion * said.no_go[0].corners_in_couch[i];
    CHECK((moved->no_go[0].corners_in_couch[i] - wanted).norm() < 1e-9);
  }
  CHECK(moved->no_go[0].name == "wound");
  CHECK((moved->fixed[0].at_in_couch - motion * said.fixed[0].at_in_couch).norm() < 1e-9);
}

TEST_CASE(
    "what is said of the scan that comes stays where it is, and a point said anew is the new one") {
  const auto same = carried({said, {}}, points_of_a_back(), max_other_misfit_m);
  REQUIRE(same.has_value());
  CHECK(same->fixed[0].at_in_couch == said.fixed[0].at_in_couch);
  const ByHand both =
      joined(said, {.no_go = {{"scar", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}},
                    .fixed = {{.name = "GV4", .at_in_couch = {1, 2, 3}}, {.name = "GV14"}}});
  CHECK(both.no_go.size() == 2);
  REQUIRE(both.fixed.size() == 2);
  CHECK(both.fixed[0].at_in_couch == Vector3(1, 2, 3));
}

TEST_CASE("nothing is guessed of a person who moved otherwise than as a whole") {
  const std::vector<Acupoint> then = points_of_a_back();
  std::vector<Acupoint> now = then;
  SUBCASE("bent") {
    now.back().at_in_couch += Vector3(0.08, 0.0, 0.0);
    const auto moved = carried({said, then}, now, max_moved_misfit_m);
    REQUIRE_FALSE(moved.has_value());
    CHECK(moved.error().fault == Fault::bad_input);
    CHECK(moved.error().message.find("15 mm are borne") != std::string::npos);
    // With nothing said there is nothing to lose.
    CHECK(carried({{}, then}, now, max_moved_misfit_m).has_value());
  }
  SUBCASE("mirrored") {
    for (Acupoint& point : now) point.at_in_couch.x() = -point.at_in_couch.x();
    CHECK_FALSE(carried({said, then}, now, max_moved_misfit_m).has_value());
  }
  SUBCASE("too few points in common") {
    now.resize(2);
    CHECK_FALSE(carried({said, then}, now, max_moved_misfit_m).has_value());
  }
}
