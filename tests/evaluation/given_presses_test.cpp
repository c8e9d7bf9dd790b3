// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/given_presses.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/units.hpp"

using namespace tuina;

namespace {

/// A press of 20 N on 6 N/mm, from where 3 N are kept, held or not.
app::TrueDeepening pressed_to(double to_n) {
  constexpr double n_per_m = 6e3, whole_n = 20.0;
  app::TrueDeepening deepening(3.0 / n_per_m);
  for (int i = 0; i <= 1000; ++i) {
    const double force_n = 3.0 + (to_n - 3.0) * std::sin(0.5 * pi * i / 1000.0);
    deepening.add(whole_n, force_n, force_n / n_per_m);
  }
  return deepening;
}

}  // namespace

TEST_CASE("a depth that was told for a press is judged by the true force there") {
  const app::TrueDeepening whole = pressed_to(20.0);
  const double deeper_m = (20.0 - 3.0) / 6e3;
  REQUIRE(whole.error(deeper_m));
  // All of a force is from 97 % of it on, 98.5 % in the mean.
  CHECK(std::abs(*whole.error(deeper_m)) < 0.02);
  CHECK(*whole.error(deeper_m + 1_mm) - *whole.error(deeper_m) ==
        doctest::Approx(0.3).epsilon(0.02));
  CHECK(*whole.error(deeper_m - 1_mm) < -0.27);
}

TEST_CASE("a press that never had its force judges nothing") {
  CHECK_FALSE(pressed_to(19.0).error(2_mm));
  CHECK_FALSE(app::TrueDeepening().error(2_mm));
}
