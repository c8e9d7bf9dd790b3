// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/creep_estimator.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/allocation.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/tissue_worlds.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue bone{4.559, 263.2}, hard{9.786, 185.4}, soft{4.275, 143.6};

/// Presses of a second each, |sin|, from 2.25 mm above where the skin is expected to `peak_n`.
void press(CreepEstimator& estimator, const TangentTissue& tissue, double peak_n,
           double duration_s) {
  Random random = make_random(1, "creep");
  const double above_m = 2.25_mm, contact_m = 0.3_mm;
  const double deepest_m = contact_m + depth_at_force(tissue, peak_n);
  for (double t = 0.0; t < duration_s; t += 1e-3) {
    const double position_m = -above_m + (deepest_m + above_m) * std::abs(std::sin(pi * t));
    estimator.update(
        t, {.depth_m = position_m + gaussian(random, 0.05_mm),
            .force_n = force_at_depth(tissue, position_m - contact_m) + gaussian(random, 0.2)});
  }
}

const sim::TissueWorld& world(const std::string& name) {
  for (const sim::TissueWorld& known : sim::tissue_worlds()) {
    if (known.name == name) return known;
  }
  FAIL("no such world: " << name);
  return sim::tissue_worlds().front();
}

}  // namespace

TEST_CASE("a force pressed into creeping tissue is found again from its depth") {
  const CreepLaw law{.tissue = {6.0, 200.0},
                     .creep = {0.1, 0.2, 0.3},
                     .layer_share = 0.2,
                     .layer_softness = 4.0,
                     .compliance_m_per_n = 2e-5,
                     .damping_s_per_m = 5.0};
  const Memory memory_n = {12.0, 6.0, 1.0};
  for (const double force_n : {0.5, 3.0, 12.0, 40.0}) {
    const CreepDepth at = depth_of(law, {force_n, memory_n, 10_mm});
    CHECK(force_of(law, at.depth_m, memory_n, 10_mm, 300.0) ==
          doctest::Approx(force_n).epsilon(1e-6));
    const double more_m = depth_of(law, {force_n + 1e-4, memory_n, 10_mm}).depth_m;
    CHECK((more_m - at.depth_m) / 1e-4 == doctest::Approx(at.m_per_n).epsilon(1e-3));
  }
  CHECK(force_of(law, -1_mm, memory_n, 0.0, 300.0) == 0.0);
}

TEST_CASE("the first loading of tissue that does not creep is its tangent law") {
  const TangentTissue found = first_loading({.tissue = hard}, 30.0);
  CHECK(found.alpha_n == doctest::Approx(hard.alpha_n).epsilon(1e-4));
  CHECK(found.beta_per_m == doctest::Approx(hard.beta_per_m).epsilon(1e-4));
}

TEST_CASE("two presses tell the tangent law of bone, hard and soft muscle to five per cent") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    CreepEstimator estimator;
    press(estimator, tissue, 40.0, 2.0);
    const TissueEstimate& estimate = estimator.estimate();
    CHECK(estimate.converged);
    CHECK(estimate.presses == 2);
    CHECK(estimate.tissue.alpha_n == doctest::Approx(tissue.alpha_n).epsilon(0.05));
    CHECK(estimate.tissue.beta_per_m == doctest::Approx(tissue.beta_per_m).epsilon(0.05));
    CHECK(estimate.contact_m == doctest::Approx(0.3_mm).epsilon(0.5));
  }
}

TEST_CASE("one press is not enough to call the next one known") {
  CreepEstimator estimator;
  press(estimator, hard, 40.0, 1.0);
  CHECK_FALSE(estimator.estimate().converged);
}

TEST_CASE("how much a tissue relaxes is learned, and its force in a hold foretold") {
  // A hold of ten seconds at one depth: the force falls by a quarter, and the forecast with it.
  Random random = make_random(7, "relaxing");
  const sim::WorldPresses presses =
      sim::press_in_world(world("qlv30"), sim::Pressing::holds, hard, random);
  CreepEstimator estimator;
  for (const auto& [time_s, felt] : presses.record) estimator.update(time_s, felt);
  estimator.settle();
  auto outlook = estimator.outlook();
  const double skin_m = estimator.estimate().contact_m;
  double time_s = presses.record.back().time_s + 30.0, first_n = 0.0, last_n = 0.0;
  for (int i = 0; i < 10000; ++i, time_s += 1e-3) {
    last_n = estimator.foretell(outlook, time_s, skin_m + 6_mm, 0.0).force_n;
    if (i == 0) first_n = last_n;
  }
  CHECK(last_n < 0.85 * first_n);
  CHECK(last_n > 0.6 * first_n);
}

TEST_CASE("whatever comes in, what comes out is finite, and nothing is taken from the heap") {
  Random random = make_random(4, "fuzz");
  CreepEstimator estimator;
  const double infinity = std::numeric_limits<double>::infinity();
  double time_s = 0.0;
  const std::size_t before = test::allocations();
  bool fine = true;
  for (int i = 0; i < 30000; ++i) {
    time_s += uniform(random, -1e-4, 2e-3);
    Press sample{.depth_m = gaussian(random, 5_mm), .force_n = gaussian(random, 30.0)};
    const double dice = uniform(random, 0.0, 1.0);
    if (dice < 0.01) sample.force_n = infinity;
    if (dice > 0.99) sample.depth_m = std::nan("");
    if (dice > 0.4 && dice < 0.401) time_s += 5.0;
    estimator.update(dice == 0.5 ? std::nan("") : time_s, sample);
    const TissueEstimate& estimate = estimator.estimate();
    fine = fine && std::isfinite(estimate.alpha_ci95_n) &&
           std::isfinite(estimate.beta_ci95_per_m) && estimate.tissue.alpha_n > 0.0 &&
           estimate.tissue.beta_per_m > 0.0 && std::isfinite(estimator.stiffness_sd(10.0));
  }
  CHECK(fine);
  CHECK(test::allocations() == before);
}
