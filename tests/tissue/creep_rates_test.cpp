// SPDX-License-Identifier: Apache-2.0
// What the creep estimator makes of records of other rates, zeros and places than a robot's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/record_estimate.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue hard{9.786, 185.4};

/// After six presses of two seconds to 30 N, with a force that is off and a skin that is elsewhere.
CreepEstimator felt(const CreepEstimator::Options& options, double from_m, double off_n,
                    double skin_m = 0.0) {
  CreepEstimator estimator(options);
  Random random = make_random(13, "elsewhere");
  for (double t = 0.0; t < 12.0; t += 1e-3) {
    const double share = 0.5 * (1.0 - std::cos(pi * t));
    const double depth_m = from_m + share * (depth_at_force(hard, 30.0) - from_m);
    estimator.update(t,
                     {.depth_m = skin_m + depth_m + gaussian(random, 0.01_mm),
                      .force_n = off_n + force_at_depth(hard, depth_m) + gaussian(random, 0.05)});
  }
  return estimator;
}

CreepEstimator::Options fine_sensors() {
  CreepEstimator::Options options = record_options();
  options.force_noise_n = 0.05;
  options.position_noise_m = 0.01_mm;
  return options;
}

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

TEST_CASE("a record that begins in contact converges only if the zero of its force is known") {
  CreepEstimator::Options told = fine_sensors();
  told.untared_sd_n = 0.1;
  const CreepEstimator tared = felt(told, 2_mm, 0.0);
  CHECK(tared.estimate().converged);
  CHECK(tared.estimate().tissue.alpha_n == doctest::Approx(hard.alpha_n).epsilon(0.05));
  CHECK(tared.estimate().tissue.beta_per_m == doctest::Approx(hard.beta_per_m).epsilon(0.05));
  for (const double off_n : {-1.0, 0.0, 1.0}) {
    CHECK_FALSE(felt(fine_sensors(), 2_mm, off_n).estimate().converged);
    CHECK(felt(fine_sensors(), -3_mm, off_n).estimate().converged);
  }
}

TEST_CASE("a skin far from where it was told to be keeps a record from converging") {
  for (const double skin_m : {3_mm, 15_mm, 30_mm, 50_mm, -20_mm}) {
    const CreepEstimator far = felt(fine_sensors(), -3_mm, 0.0, skin_m);
    CHECK(far.skin_as_told() == (std::abs(skin_m) < 5_mm));
    CHECK(far.estimate().converged == far.skin_as_told());
    CreepEstimator::Options told = fine_sensors();
    told.contact_sd_m = 30_mm;
    const CreepEstimator found = felt(told, -3_mm, 0.0, skin_m);
    CHECK(found.estimate().converged);
    CHECK(found.estimate().tissue.beta_per_m == doctest::Approx(hard.beta_per_m).epsilon(0.05));
  }
}
