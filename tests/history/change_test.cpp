// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/change.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

constexpr int places = 20;

/// Standard deviations of the logarithm: between sessions, of each press as its interval tells, and
/// of what all places of a session share.
struct Errors {
  double scatter = 0.03, noise = 0.02, shared = 0.0;
};

/// Sessions of one person whose places differ in hardness, with the scatter between sessions and
/// the noise of each press that its interval tells of.
struct FeltPerson {
  explicit FeltPerson(std::uint64_t seed, Errors made = {})
      : random(make_random(seed, "history")), errors(made) {
    for (double& log : logs) log = gaussian(random, 0.4);
  }
  Visit visit(double log_change = 0.0) {
    Visit visit;
    const double shared = log_change + gaussian(random, errors.shared);
    for (const double usual : logs) {
      const double alpha_n = std::exp(usual + shared + gaussian(random, errors.scatter) +
                                      gaussian(random, errors.noise));
      visit.tissue.push_back({.name = "P" + std::to_string(visit.tissue.size()),
                              .alpha_n = alpha_n,
                              .alpha_ci95_n = 1.96 * errors.noise * alpha_n});
    }
    return visit;
  }

  Random random;
  Errors errors;
  double logs[places] = {};
};

}  // namespace

TEST_CASE("in 95 of 100 sessions without a change none is called real, whatever the scatter") {
  int wrong = 0, wrong_whole = 0;
  double told = 0.0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    FeltPerson person(seed, {.shared = assumed_shared_scatter});
    const std::vector<Visit> earlier = {person.visit(), person.visit(), person.visit(),
                                        person.visit()};
    const Changes changes = changes_between(earlier.back(), person.visit(), earlier);
    REQUIRE(changes.places.size() == places);
    CHECK_FALSE(changes.scatter_assumed);
    told += changes.scatter / 400.0;
    REQUIRE(changes.whole);
    bool any = changes.whole->real;
    wrong_whole += any ? 1 : 0;
    for (const Change& place : changes.places) any = any || place.real;
    wrong += any ? 1 : 0;
  }
  CAPTURE(wrong);
  CAPTURE(wrong_whole);
  CHECK(told == doctest::Approx(Errors().scatter).epsilon(0.1).scale(1e-6));
  // Of 400 sessions 20 are meant; 32 are 2.7 standard deviations more.
  CHECK(wrong <= 32);
  CHECK(wrong >= 5);         // a test that never errs would find nothing either
  CHECK(wrong_whole <= 18);  // 10 are meant
}

TEST_CASE("however presses err, and however few sessions there were, nothing is called real") {
  constexpr int trials = 400;
  int max_wrong = 0;
  for (const int sessions : {1, 2, 6}) {
    for (const double between : {0.0, 0.02, 0.05, 0.1}) {
      for (const double of_press : {0.005, 0.02, 0.05}) {
        int wrong = 0;
        for (std::uint64_t seed = 1; seed <= trials; ++seed) {
          FeltPerson person(seed, {between, of_press, assumed_shared_scatter});
          std::vector<Visit> earlier;
          for (int i = 0; i < sessions; ++i) earlier.push_back(person.visit());
          const Changes changes = changes_between(earlier.back(), person.visit(), earlier);
          bool any = changes.whole->real;
          for (const Change& place : changes.places) any = any || place.real;
          wrong += any ? 1 : 0;
        }
        max_wrong = std::max(max_wrong, wrong);
      }
    }
  }
  MESSAGE("at most ", max_wrong, " of ", trials, " sessions were wrong");
  // The most of 36 numbers, each 20 at most in the mean.
  CHECK(max_wrong <= 34);
}

TEST_CASE("a place that has become harder is found, and its interval holds the change") {
  int found = 0, held = 0;
  constexpr int trials = 300;
  for (std::uint64_t seed = 1; seed <= trials; ++seed) {
    FeltPerson person(seed);
    const std::vector<Visit> earlier = {person.visit(), person.visit(), person.visit()};
    Visit after = person.visit();
    VisitTissue& harder = after.tissue.front();
    harder.alpha_n *= 1.3;
    harder.alpha_ci95_n *= 1.3;
    const Changes changes = changes_between(earlier.back(), after, earlier);
    for (const Change& place : changes.places) {
      if (place.name != "P0") continue;
      found += place.real ? 1 : 0;
      held += place.low < 0.3 && 0.3 < place.high ? 1 : 0;
    }
  }
  CHECK(found > trials * 80 / 100);
  CHECK(held > trials * 91 / 100);
  CHECK(held < trials * 99 / 100);
}

TEST_CASE("a tenth that all places share is found where no single place could tell it") {
  int whole = 0, single = 0, held = 0;
  constexpr int trials = 300;
  for (std::uint64_t seed = 1; seed <= trials; ++seed) {
    FeltPerson person(seed);
    const std::vector<Visit> earlier = {person.visit(), person.visit(), person.visit()};
    const Changes changes = changes_between(earlier.back(), person.visit(std::log(1.1)), earlier);
    REQUIRE(changes.whole);
    whole += changes.whole->real && changes.whole->change > 0.0 ? 1 : 0;
    held += changes.whole->low < 0.1 && 0.1 < changes.whole->high ? 1 : 0;
    for (const Change& place : changes.places) single += place.real ? 1 : 0;
  }
  CHECK(whole > trials * 95 / 100);
  CHECK(held > trials * 91 / 100);
  CHECK(single < trials * places / 4);
}

TEST_CASE("one place that has changed is no change of the whole back") {
  int whole = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    FeltPerson person(seed);
    const std::vector<Visit> earlier = {person.visit(), person.visit()};
    Visit after = person.visit();
    after.tissue.front().alpha_n *= 2.0;
    after.tissue.front().alpha_ci95_n *= 2.0;
    const Changes changes = changes_between(earlier.back(), after, earlier);
    CHECK(changes.places.front().real);
    whole += changes.whole->real ? 1 : 0;
  }
  CHECK(whole <= 10);
}

TEST_CASE("sessions in another position say nothing of the scatter in this one") {
  FeltPerson person(1);
  std::vector<Visit> earlier = {person.visit(), person.visit(), person.visit(0.5)};
  for (Visit& visit : earlier) visit.position = "prone";
  Visit after = person.visit();
  after.position = "sitting";
  CHECK(changes_between(earlier.back(), after, earlier).scatter_assumed);
  after.position = "prone";
  CHECK_FALSE(changes_between(earlier.back(), after, earlier).scatter_assumed);
}

TEST_CASE("without earlier sessions the scatter is assumed, and places felt once are left out") {
  Visit before, after;
  before.tissue = {{.name = "A", .alpha_n = 2.0, .alpha_ci95_n = 0.01},
                   {.name = "A", .alpha_n = 4.0, .alpha_ci95_n = 0.01},
                   {.name = "B", .alpha_n = 3.0, .alpha_ci95_n = 0.01}};
  after.tissue = {{.name = "A", .alpha_n = 4.1, .alpha_ci95_n = 0.01},
                  {.name = "B", .alpha_n = 0.0, .alpha_ci95_n = 0.01}};
  const Changes changes = changes_between(before, after);
  CHECK(changes.scatter_assumed);
  CHECK_FALSE(changes.whole);  // of one place
  REQUIRE(changes.places.size() == 1);
  CHECK(changes.places[0].change == doctest::Approx(0.025).epsilon(1e-6).scale(1e-6));
  CHECK_FALSE(changes.places[0].real);
}
