// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/change.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

constexpr double scatter = 0.03, noise = 0.02;  // standard deviations of the logarithm
constexpr int places = 20;

/// Sessions of one person whose places differ, with the scatter between sessions and the noise of
/// each press that its interval tells of.
struct FeltPerson {
  explicit FeltPerson(std::uint64_t seed) : random(make_random(seed, "history")) {
    for (double& log : logs) log = gaussian(random, 0.4);
  }
  Visit visit(double log_change = 0.0) {
    Visit visit;
    for (int i = 0; i < places; ++i) {
      const double log = logs[i] + log_change + gaussian(random, scatter) + gaussian(random, noise);
      const double stiffness = std::exp(log);
      visit.tissue.push_back({.name = "P" + std::to_string(i),
                              .stiffness_n_per_mm = stiffness,
                              .stiffness_ci95_n_per_mm = 1.96 * noise * stiffness});
    }
    return visit;
  }

  Random random;
  double logs[places] = {};
};

}  // namespace

TEST_CASE("in 95 of 100 sessions without a change none is called real, whatever the scatter") {
  int sessions = 0, wrong = 0;
  double told = 0.0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    FeltPerson person(seed);
    const std::vector<Visit> earlier = {person.visit(), person.visit(), person.visit(),
                                        person.visit()};
    const Changes changes = changes_between(earlier.back(), person.visit(), earlier);
    REQUIRE(changes.places.size() == places);
    CHECK_FALSE(changes.scatter_assumed);
    told += changes.scatter / 400.0;
    bool any = false;
    for (const PlaceChange& place : changes.places) any = any || place.real;
    ++sessions;
    wrong += any ? 1 : 0;
  }
  CAPTURE(wrong);
  CHECK(told == doctest::Approx(scatter).epsilon(0.1).scale(1e-6));
  // Of 400 sessions 20 are meant; 32 are 2.7 standard deviations more.
  CHECK(wrong <= 32);
  CHECK(wrong >= 5);  // a test that never errs would find nothing either
}

TEST_CASE("a place that has become harder is found, and its interval holds the change") {
  int found = 0, held = 0;
  constexpr int trials = 300;
  for (std::uint64_t seed = 1; seed <= trials; ++seed) {
    FeltPerson person(seed);
    const std::vector<Visit> earlier = {person.visit(), person.visit(), person.visit()};
    Visit after = person.visit();
    VisitTissue& harder = after.tissue.front();
    harder.stiffness_n_per_mm *= 1.3;
    harder.stiffness_ci95_n_per_mm *= 1.3;
    const Changes changes = changes_between(earlier.back(), after, earlier);
    for (const PlaceChange& place : changes.places) {
      if (place.name != "P0") continue;
      found += place.real ? 1 : 0;
      held += place.low < 0.3 && 0.3 < place.high ? 1 : 0;
    }
  }
  CHECK(found > trials * 95 / 100);
  CHECK(held > trials * 91 / 100);
  CHECK(held < trials * 99 / 100);
}

TEST_CASE("without earlier sessions the scatter is assumed, and places felt once are left out") {
  Visit before, after;
  before.tissue = {{.name = "A", .stiffness_n_per_mm = 2.0, .stiffness_ci95_n_per_mm = 0.01},
                   {.name = "A", .stiffness_n_per_mm = 4.0, .stiffness_ci95_n_per_mm = 0.01},
                   {.name = "B", .stiffness_n_per_mm = 3.0, .stiffness_ci95_n_per_mm = 0.01}};
  after.tissue = {{.name = "A", .stiffness_n_per_mm = 4.1, .stiffness_ci95_n_per_mm = 0.01},
                  {.name = "B", .stiffness_n_per_mm = 0.0, .stiffness_ci95_n_per_mm = 0.01}};
  const Changes changes = changes_between(before, after);
  CHECK(changes.scatter_assumed);
  REQUIRE(changes.places.size() == 1);
  CHECK(changes.places[0].change == doctest::Approx(0.025).epsilon(1e-6).scale(1e-6));
  CHECK_FALSE(changes.places[0].real);
}
