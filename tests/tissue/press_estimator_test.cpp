// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/press_estimator.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue bone{4.559, 263.2}, hard{9.786, 185.4}, soft{4.275, 143.6};

/// Presses of a second each, |sin|, from 2.25 mm above where the skin is expected to `peak_n`.
void press(PressEstimator& estimator, const TangentTissue& tissue, double peak_n, double from_s,
           double duration_s, std::uint64_t seed, double contact_m = 0.3_mm) {
  Random random = make_random(seed, "press");
  const double above_m = 2.25_mm, deepest_m = contact_m + depth_at_force(tissue, peak_n);
  for (double t = 0.0; t < duration_s; t += 1e-3) {
    const double position_m = -above_m + (deepest_m + above_m) * std::abs(std::sin(pi * t));
    const double force_n = force_at_depth(tissue, position_m - contact_m);
    estimator.update(from_s + t, {.depth_m = position_m + gaussian(random, 0.05_mm),
                                  .force_n = force_n + gaussian(random, 0.2)});
  }
}

}  // namespace

TEST_CASE("two presses tell alpha and beta of bone, hard and soft muscle to five per cent") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    PressEstimator estimator;
    press(estimator, tissue, 40.0, 0.0, 2.0, 1);
    const TissueEstimate& estimate = estimator.estimate();
    CHECK(estimate.converged);
    CHECK(estimate.presses == 2);
    CHECK(estimate.tissue.alpha_n == doctest::Approx(tissue.alpha_n).epsilon(0.05));
    CHECK(estimate.tissue.beta_per_m == doctest::Approx(tissue.beta_per_m).epsilon(0.05));
    CHECK(estimate.contact_m == doctest::Approx(0.3_mm).epsilon(0.5));
  }
}

TEST_CASE("a press lighter than alpha never counts as converged, however often it is repeated") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    PressEstimator estimator;
    press(estimator, tissue, tissue.alpha_n, 0.0, 20.0, 2);
    CHECK_FALSE(estimator.estimate().converged);
  }
}

TEST_CASE("ten minutes of hovering do not wind the estimate up") {
  PressEstimator hovered, fresh;
  for (double t = 0.0; t < 600.0; t += 0.01) hovered.update(t, {.depth_m = -20_mm, .force_n = 0.0});
  press(hovered, hard, 40.0, 600.0, 1.0, 3);
  press(fresh, hard, 40.0, 0.0, 1.0, 3);
  CHECK(hovered.estimate().tissue.alpha_n ==
        doctest::Approx(fresh.estimate().tissue.alpha_n).epsilon(0.002));
}

TEST_CASE("whatever comes in, what comes out is finite and positive") {
  Random random = make_random(4, "fuzz");
  PressEstimator estimator;
  const double infinity = std::numeric_limits<double>::infinity();
  double time_s = 0.0;
  for (int i = 0; i < 200000; ++i) {
    time_s += uniform(random, -1e-4, 2e-3);
    Press sample{.depth_m = gaussian(random, 5_mm), .force_n = gaussian(random, 30.0)};
    const double dice = uniform(random, 0.0, 1.0);
    if (dice < 0.01) sample.force_n = infinity;
    if (dice > 0.99) sample.depth_m = std::nan("");
    if (dice > 0.4 && dice < 0.401) time_s += 5.0;
    estimator.update(dice == 0.5 ? std::nan("") : time_s, sample);
    const TissueEstimate& estimate = estimator.estimate();
    REQUIRE(std::isfinite(estimate.tissue.alpha_n));
    REQUIRE(std::isfinite(estimate.alpha_ci95_n));
    REQUIRE(std::isfinite(estimate.beta_ci95_per_m));
    REQUIRE(estimate.tissue.alpha_n > 0.0);
    REQUIRE(estimate.tissue.beta_per_m > 0.0);
  }
}

TEST_CASE("a breath of three millimetres and a yielding torso are not mistaken for tissue") {
  Random random = make_random(5, "in the loop");
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    PressEstimator estimator({.contact_sd_m = 3_mm, .torso_n_per_m = 35e3, .breathing_m = 3_mm});
    for (double t = 0.0; t < 5.0; t += 1e-3) {
      // 3 N are kept between presses of a second to 25 N; the torso is 15 % stiffer than assumed.
      const double lift = std::max(0.0, t - 0.5);
      const double force_n = t < 0.3 ? 0.0 : 3.0 + 22.0 * std::pow(std::sin(pi * lift), 2);
      const double skin_m = 1.0_mm + 1.5_mm * std::sin(2.0 * pi * 0.3 * t);
      const double position_m = force_n > 0.0
                                    ? skin_m + force_n / 40e3 + depth_at_force(tissue, force_n)
                                    : skin_m - (0.3 - t) * 0.05;
      estimator.update(t, {.depth_m = position_m + gaussian(random, 0.05_mm),
                           .force_n = force_n + gaussian(random, 0.2)});
    }
    const TissueEstimate& estimate = estimator.estimate();
    CHECK(estimate.presses >= 4);
    CHECK(estimate.tissue.alpha_n == doctest::Approx(tissue.alpha_n).epsilon(0.08));
    CHECK(estimate.tissue.beta_per_m == doctest::Approx(tissue.beta_per_m).epsilon(0.05));
  }
}

TEST_CASE("a tool that is heavy beyond its force sensor does not make the tissue look softer") {
  // Four presses of a second out of free air; the sensor feels 1 kg accelerated.
  const auto felt = [](double tool_mass_kg) {
    PressEstimatorOptions options = pressed_by_robot(0.0, tool_mass_kg);
    options.force_delay_s = 0.0;
    PressEstimator estimator(options);
    Random random = make_random(8, "inertia");
    const auto depth_m = [](double t) { return 4_mm - 5.5_mm * std::cos(2.0 * pi * t); };
    for (double t = 0.0; t < 4.0; t += 1e-3) {
      const double acceleration = 5.5_mm * 4.0 * pi * pi * std::cos(2.0 * pi * t);
      const double force_n = force_at_depth(soft, depth_m(t));
      estimator.update(t, {.depth_m = depth_m(t) + gaussian(random, 0.003_mm),
                           .force_n = force_n + 1.0 * acceleration + gaussian(random, 0.05)});
    }
    return estimator.estimate().tissue;
  };
  CHECK(felt(1.0).alpha_n == doctest::Approx(soft.alpha_n).epsilon(0.02));
  CHECK(felt(1.0).beta_per_m == doctest::Approx(soft.beta_per_m).epsilon(0.02));
  CHECK(std::abs(felt(0.0).alpha_n / soft.alpha_n - 1.0) > 0.04);
}
