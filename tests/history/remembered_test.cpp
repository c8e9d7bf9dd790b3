// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/remembered.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/history/some_visit.hpp"
#include "tuina/history/change.hpp"

using namespace tuina;
using namespace tuina::history;
using test::visit_at;

TEST_CASE("the last session that tells of it says wish and tissue, and what it says is widened") {
  std::vector<Visit> visits = {visit_at("a", "2026-01-01T09:00:00Z", 2.0),
                               visit_at("b", "2026-01-02T09:00:00Z", 2.0),
                               visit_at("c", "2026-01-03T09:00:00Z", 2.0)};
  CHECK(last_wish(visits) == nullptr);
  visits[0].intensity = 0.8;
  visits[1].intensity = 1.15;
  visits[2].intensity = 0.5;
  visits[2].ended = false;  // cut short
  visits[1].position = "sitting";
  CHECK(last_wish(visits) == &visits[1]);
  CHECK(last_felt(visits, std::nullopt) == &visits[1]);
  CHECK(last_felt(visits, BodyPosture::prone) == &visits[0]);
  visits[1].tissue.clear();
  CHECK(last_felt(visits, std::nullopt) == &visits[0]);

  visits[0].tissue.push_back(visits[0].tissue.front());
  visits[0].tissue.push_back(visits[0].tissue.front());
  visits[0].tissue[1].alpha_n = 7.0;  // pressed again later
  visits[0].tissue[2].name = "BL50_L";
  visits[0].tissue[2].converged = false;
  const auto known = known_tissue(visits[0], visits);
  CHECK(known.position == BodyPosture::prone);
  REQUIRE(known.places.size() == 1);
  CHECK(known.places[0].tissue.alpha_n == 7.0);
  CHECK(known.places[0].tissue.beta_per_m == 20.0);
  const double day_to_day = std::sqrt(2.0) * assumed_scatter, press = 0.02 / 1.96 / 2.0;
  CHECK(known.places[0].log_sd == doctest::Approx(std::hypot(day_to_day, press)).scale(1e-6));
  CHECK(known.lay[0].at_in_couch == visits[0].acupoints[0].at_in_couch);
}

TEST_CASE("the newest session in a position that ended says where the acupoints lay") {
  std::vector<Visit> visits = {visit_at("a", "2026-01-01T09:00:00Z", 2.0),
                               visit_at("b", "2026-01-02T09:00:00Z", 2.0),
                               visit_at("c", "2026-01-03T09:00:00Z", 2.0)};
  visits[1].position = "sitting";
  visits[1].acupoints[0].at_in_couch.x() += 1.0;
  visits[2].ended = false;
  const auto any = last_lay(visits, std::nullopt), prone = last_lay(visits, BodyPosture::prone);
  REQUIRE((any && prone));
  CHECK(any->position == BodyPosture::sitting);
  CHECK(any->lay[0].at_in_couch == visits[1].acupoints[0].at_in_couch);
  CHECK(prone->lay[0].at_in_couch == visits[0].acupoints[0].at_in_couch);
  CHECK(any->places.empty());
  CHECK_FALSE(last_lay({}, std::nullopt));
}

TEST_CASE("the newest session that ended and in which something was said counts in any position") {
  std::vector<Visit> visits = {
      visit_at("a", "2026-01-01T09:00:00Z", 2.0), visit_at("b", "2026-01-02T09:00:00Z", 2.0),
      visit_at("c", "2026-01-03T09:00:00Z", 2.0), visit_at("d", "2026-01-04T09:00:00Z", 2.0)};
  CHECK(last_said(visits) == nullptr);
  visits[0].said = visits[1].said = visits[3].said = "{}";
  visits[1].position = "sitting";  // what must not be touched sitting must not be touched lying
  visits[3].ended = false;
  CHECK(last_said(visits) == &visits[1]);
}
