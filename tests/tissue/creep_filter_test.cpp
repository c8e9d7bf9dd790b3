// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/creep_filter.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tuina::tissue;

TEST_CASE("what one place of a person has pulled aside comes back with those that follow") {
  const PressEstimatorOptions options = on_unknown_torso(pressed_by_robot(18e3, 0.16));
  const CreepHypothesis remembers{.creep = 0.08, .breathing_m = 3e-3};
  const CreepFilter::Belief anybody = CreepFilter(options, remembers).now();
  // A place that says, and is sure, that much gives way beneath and that the layers are thick.
  CreepFilter::Belief person = anybody;
  constexpr int first = CreepFilter::log_creep, last = CreepFilter::log_softness;
  for (int i = first; i <= last; ++i) {
    person.mean(i) += 1.0;
    person.covariance(i, i) = 1e-4;
  }
  for (int place = 0; place < 10; ++place) {
    CAPTURE(place);
    CreepFilter next(options, remembers);
    next.expect_person(person);
    for (int i = first; i <= last; ++i) {
      CAPTURE(i);
      const double was = person.mean(i) - anybody.mean(i);
      const double is = next.now().mean(i) - anybody.mean(i);
      CHECK(is > 0.0);
      CHECK(is < was);
      CHECK(next.now().covariance(i, i) > person.covariance(i, i));
      CHECK(next.now().covariance(i, i) <= anybody.covariance(i, i) * (1.0 + 1e-12));
    }
    person = next.now();
  }
  // A torso is known to a third, which is hardly more than places differ.
  CHECK(person.mean(CreepFilter::log_compliance) ==
        doctest::Approx(anybody.mean(CreepFilter::log_compliance)).epsilon(0.001));
}

TEST_CASE("what is taken for granted stays so at the next place") {
  const PressEstimatorOptions options = on_same_torso(pressed_by_robot(18e3, 0.16));
  const CreepHypothesis springs{.creep = 0.0, .breathing_m = 3e-3};
  const CreepFilter::Belief anybody = CreepFilter(options, springs).now();
  CreepFilter::Belief person = anybody;
  person.mean(CreepFilter::log_compliance) += 1.0;
  CreepFilter next(options, springs);
  next.expect_person(person);
  CHECK(next.now().mean.isApprox(anybody.mean));
  CHECK(next.now().covariance.isApprox(anybody.covariance));
}
