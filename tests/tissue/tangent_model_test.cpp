// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/tangent_model.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tuina;
using namespace tuina::tissue;

namespace {
constexpr TangentTissue bone{4.559, 263.2}, hard{9.786, 185.4}, soft{4.275, 143.6};
}

TEST_CASE("depth and force are each other's inverse, also beyond the pole") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (double force_n = 0.5; force_n < 500.0; force_n *= 1.5) {
      CHECK(force_at_depth(tissue, depth_at_force(tissue, force_n)) == doctest::Approx(force_n));
    }
    CHECK(std::isfinite(force_at_depth(tissue, 1.0)));
  }
}

TEST_CASE("the stiffness is the slope of the law and has no kink where the law is continued") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (double depth_m = 0.5e-3; depth_m < 15e-3; depth_m += 0.37e-3) {
      const double step_m = 1e-8;
      const double slope =
          (force_at_depth(tissue, depth_m + step_m) - force_at_depth(tissue, depth_m - step_m)) /
          (2.0 * step_m);
      CHECK(stiffness_at_depth(tissue, depth_m) == doctest::Approx(slope).epsilon(1e-4));
      const double force_n = force_at_depth(tissue, depth_m);
      CHECK(stiffness_at_force(tissue, force_n) == doctest::Approx(slope).epsilon(1e-4));
    }
  }
}

TEST_CASE("bone is far stiffer at 20 N than soft muscle") {
  CHECK(stiffness_at_force(bone, 20.0) == doctest::Approx(24.3e3).epsilon(0.02));
  CHECK(stiffness_at_force(soft, 20.0) < 15e3);
}

TEST_CASE("the law through two depths of a law is that law") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (const double force_n : {5.0, 20.0, 60.0}) {
      const TangentTissue again = tangent_through(force_n, depth_at_force(tissue, force_n),
                                                  depth_at_force(tissue, 0.5 * force_n));
      CHECK(again.alpha_n == doctest::Approx(tissue.alpha_n).epsilon(1e-6));
      CHECK(again.beta_per_m == doctest::Approx(tissue.beta_per_m).epsilon(1e-6));
    }
  }
}

TEST_CASE("the law through depths that no tangent has still meets the force") {
  // Softer at first than any tangent, and a straight line.
  for (const double half_m : {4.9e-3, 2.5e-3}) {
    const TangentTissue nearest = tangent_through(20.0, 5e-3, half_m);
    CHECK(std::isfinite(nearest.alpha_n));
    CHECK(depth_at_force(nearest, 20.0) == doctest::Approx(5e-3).epsilon(0.02));
  }
}
