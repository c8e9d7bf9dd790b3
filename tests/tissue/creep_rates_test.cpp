// SPDX-License-Identifier: Apache-2.0
// What the creep estimator makes of records at other rates than a robot's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue hard{9.786, 185.4};

}  // namespace

TEST_CASE("a record of fifty samples a second is followed for as long as it goes on") {
  // The tool never lets go, so each sample is a segment of its own.
  CreepEstimator estimator;
  Random random = make_random(11, "slowly");
  double said_m = 0.0, changed_s = 0.3, longest_s = 0.0;
  for (double t = 0.0; t < 60.0; t += 0.02) {
    const double depth_m = t < 0.3 ? -2_mm : 4.5_mm - 3_mm * std::cos(3.1 * pi * t);
    estimator.update(t, {.depth_m = depth_m + gaussian(random, 0.05_mm),
                         .force_n = force_at_depth(hard, depth_m) + gaussian(random, 0.2)});
    if (estimator.estimate().contact_m != said_m) changed_s = t;
    said_m = estimator.estimate().contact_m;
    longest_s = std::max(longest_s, t - changed_s);
  }
  CHECK(longest_s < 0.2);
}

TEST_CASE("samples a tenth of a second apart never count as enough") {
  for (const double step_s : {0.1, 0.02}) {
    CreepEstimator estimator;
    Random random = make_random(12, "seldom");
    bool ever = false;
    for (double t = 0.0; t < 30.0; t += step_s) {
      const double depth_m = 8_mm * std::sin(0.5 * pi * t) * std::sin(0.5 * pi * t) - 2_mm;
      estimator.update(t, {.depth_m = depth_m + gaussian(random, 0.01_mm),
                           .force_n = force_at_depth(hard, depth_m) + gaussian(random, 0.05)});
      ever = ever || estimator.estimate().converged;
    }
    CHECK(ever == (step_s < 0.05));
  }
}
