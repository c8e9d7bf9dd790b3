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

TEST_CASE("beyond what was felt a band holds what tissue of another law gives") {
  // An exponential, which a tangent cannot be told from below the strongest press.
  const auto force_n = [](double depth_m) {
    return depth_m > 0.0 ? 2.0 * (std::exp(depth_m / 3.5_mm) - 1.0) : 0.0;
  };
  const auto depth_m = [](double of_n) { return 3.5_mm * std::log(1.0 + 0.5 * of_n); };
  for (const double beyond : {1.0, 1.5, 2.0, 2.5}) {
    CAPTURE(beyond);
    Random random = make_random(2, "exponential");
    CreepEstimator estimator;
    const auto place_m = [&](double peak_n, double time_s) {
      const double above_m = 2_mm;
      return -above_m + (depth_m(peak_n) + above_m) * std::abs(std::sin(pi * time_s));
    };
    double time_s = 0.0;
    for (; time_s < 3.0; time_s += 1e-3) {
      const double at_m = place_m(20.0, time_s);
      estimator.update(time_s, {.depth_m = at_m + gaussian(random, 0.05_mm),
                                .force_n = force_n(at_m) + gaussian(random, 0.2)});
    }
    CreepEstimator::Outlook outlook = estimator.outlook();
    CreepEstimator::ForceBand told;
    double before_m = place_m(20.0, time_s);
    for (; time_s < 3.5; time_s += 1e-3) {
      const double at_m = place_m(beyond * 20.0, time_s);
      told = estimator.foretell(outlook, time_s, at_m, 1e3 * (at_m - before_m));
      before_m = at_m;
    }
    CAPTURE(told.force_n);
    CHECK(told.low_n <= beyond * 20.0);
    CHECK(told.high_n >= beyond * 20.0);
    if (beyond == 1.0) CHECK(told.high_n - told.low_n < 4.0);
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

namespace {

struct Told {
  int presses = 0;
  double half_width = 0.0;  ///< of the force of a next press as strong; 1 after a surprise
  double error = 0.0;       ///< of the force told for the true depth of such a press, as a share
};

/// Presses of a session: two that probe, the third as ordered and held for 1.5 s, 3 N kept between
/// them, by a tool that follows skin which breathes by 3 mm; in the second one the person sighs.
Told told_by_a_session(const TangentTissue& tissue, double ordered_n, std::uint64_t seed,
                       double sigh_m = 0.0) {
  constexpr double kept_n = 3.0, torso_n_per_m = 35e3;
  CreepEstimator estimator(pressed_by_robot(torso_n_per_m, 0.16));
  Random random = make_random(seed, "session");
  const double rate = 2.0 * pi * uniform(random, 0.18, 0.32), phase = uniform(random, 0.0, 6.0);
  double time_s = 0.0, sighed_m = 0.0;
  const auto feel = [&](double force_n, double above_m = 0.0) {
    const double breath_m = 1.5_mm * std::sin(rate * time_s + phase) - sighed_m;
    const double depth_m = depth_at_force(tissue, force_n) + force_n / torso_n_per_m - above_m;
    estimator.update(time_s,
                     {.depth_m = breath_m + depth_m, .force_n = force_n + gaussian(random, 0.05)});
    time_s += 1e-3;
  };
  for (int i = 500; i > 0; --i) feel(0.0, i * 0.02_mm);
  for (int i = 0; i < 300; ++i) feel(kept_n * i / 300.0);
  for (const auto& [peak_n, hold_s] :
       {std::pair{8.0, 0.0}, std::pair{0.6 * ordered_n, 0.0}, std::pair{ordered_n, 1.5}}) {
    for (double t = 0.0; t < 1.2 + hold_s; t += 1e-3) {
      const double edge_s = t < 0.5 ? t : std::max(0.5, t - hold_s);
      const double swell = edge_s < 1.0 ? 0.5 * (1.0 - std::cos(2.0 * pi * edge_s)) : 0.0;
      sighed_m = estimator.estimate().presses == 1 ? sigh_m * swell : 0.0;
      feel(kept_n + (peak_n - kept_n) * swell);
    }
  }
  auto outlook = estimator.outlook();
  const double skin_m = 1.5_mm * std::sin(rate * time_s + phase);
  const double met_n =
      estimator
          .foretell(outlook, time_s,
                    skin_m + depth_at_force(tissue, ordered_n) + ordered_n / torso_n_per_m, 0.0)
          .force_n;
  return {.presses = estimator.estimate().presses,
          .half_width = estimator.surprised() ? 1.0 : estimator.force_half_width(ordered_n),
          .error = met_n / ordered_n - 1.0};
}

}  // namespace

TEST_CASE("three presses of a session foretell the next one on most breathing tissues") {
  int known = 0, held = 0, all = 0;
  for (const auto& [tissue, ordered_n] :
       {std::pair{bone, 15.0}, std::pair{hard, 22.0}, std::pair{soft, 22.0}}) {
    for (std::uint64_t seed = 1; seed <= 7; ++seed) {
      const Told told = told_by_a_session(tissue, ordered_n, seed);
      CAPTURE(tissue.alpha_n);
      CAPTURE(seed);
      CHECK(told.presses == 3);
      held += std::abs(told.error) <= told.half_width;
      known += told.half_width <= well_foretold_share;
      ++all;
    }
  }
  CHECK(5 * known >= 4 * all);
  CHECK(10 * held >= 9 * all);
}

TEST_CASE("after a sigh in one press most of the next ones are still foretold") {
  double quiet = 0.0, sighed = 0.0;
  for (const TangentTissue& tissue : {hard, soft}) {
    for (std::uint64_t seed = 1; seed <= 7; ++seed) {
      quiet += told_by_a_session(tissue, 22.0, seed).half_width / 14.0;
      sighed += told_by_a_session(tissue, 22.0, seed, 1.5_mm).half_width / 14.0;
    }
  }
  CAPTURE(quiet);
  CAPTURE(sighed);
  CHECK(sighed > quiet);
  CHECK(sighed < 0.5);  // 0.61 where a surprise counts in full
}

TEST_CASE("a cough under the tool steers nothing by a law that it does not follow") {
  for (const double coughed_m : {8_mm, 15_mm}) {
    Random random = make_random(1, "cough");
    CreepEstimator estimator;
    press(estimator, hard, 20.0, 3.0);
    REQUIRE(estimator.estimate().converged);
    const double true_n_per_m = stiffness_at_force(hard, 10.0);
    for (int i = 0; i < 1500; ++i) {
      const double t = i * 1e-3;
      // The chest jumps out against the tool, falls away beneath it and comes back.
      const double skin_m = t < 0.4 ? coughed_m * std::sin(2.0 * pi * t / 0.4) : 0.0;
      const double force_n = std::max(0.0, 6.0 + 8.0 * skin_m / coughed_m);
      const double depth_m = 0.3_mm + depth_at_force(hard, 6.0) - 0.9 * skin_m;
      estimator.update(3.0 + t, {.depth_m = depth_m + gaussian(random, 0.05_mm),
                                 .force_n = force_n + gaussian(random, 0.2)});
      if (!estimator.estimate().converged) continue;
      CAPTURE(t);
      const double ratio = stiffness_at_force(estimator.estimate().tissue, 10.0) / true_n_per_m;
      CHECK(ratio > 0.5);
      CHECK(ratio < 2.0);
    }
  }
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
