// SPDX-License-Identifier: Apache-2.0
// The way of a tool from one place above the back to another.
#include <doctest/doctest.h>

#include <cmath>

#include "tuina/motion/free_path.hpp"

using namespace tuina;

TEST_CASE("a way over a round back is lifted as much as the back rises between, and no more") {
  constexpr double radius_m = 0.15;
  CHECK(motion::lift_over_back_m(0.0) == 0.0);
  for (const double half_rad : {0.1, 0.3, 0.5, 0.8}) {
    const double chord_m = 2.0 * radius_m * std::sin(half_rad);
    CHECK(motion::lift_over_back_m(chord_m) ==
          doctest::Approx(radius_m * (1.0 - std::cos(half_rad))));
  }
  for (const double chord_m : {0.3, 1.0}) CHECK(motion::lift_over_back_m(chord_m) == 80e-3);
}
