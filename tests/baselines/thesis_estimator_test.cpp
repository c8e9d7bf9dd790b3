// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/thesis_estimator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/sim/press_scenarios.hpp"

using namespace tuina;
using namespace tuina::baselines;
using namespace tuina::tissue;

namespace {

constexpr std::array<TangentTissue, 3> table_6_1 = {
    {{4.559, 263.2}, {9.786, 185.4}, {4.275, 143.6}}};

struct Outcome {
  double within_5_percent_s = 0.0, within_1_percent_s = 0.0, last_error = 0.0;
};

/// From when on both parameters stay within 5 and 1 per cent, over the 45 s of 6.3.1.
Outcome run(const ThesisEstimatorOptions& options, const TangentTissue& truth,
            double force_noise_n = 0.0) {
  Random random = make_random(1, "thesis");
  ThesisEstimator estimator(options);
  Outcome outcome;
  for (const TimedPress& sample : sim::simulate_thesis_presses(truth, 45.0)) {
    Press press = sample.press;
    press.force_n += gaussian(random, force_noise_n);
    estimator.update(sample.time_s, press);
    const TangentTissue found = estimator.estimate().tissue;
    outcome.last_error = !estimator.valid()
                             ? 1.0
                             : std::max(std::abs(found.alpha_n / truth.alpha_n - 1.0),
                                        std::abs(found.beta_per_m / truth.beta_per_m - 1.0));
    if (outcome.last_error > 0.05) outcome.within_5_percent_s = sample.time_s;
    if (outcome.last_error > 0.01) outcome.within_1_percent_s = sample.time_s;
  }
  return outcome;
}

const ThesisEstimatorOptions r1{
    .gain_per_s = 0.2, .initial_covariance = 1000.0, .normalised = false};
const ThesisEstimatorOptions r2{.gain_per_s = 5.0, .unit_m = 1.0};

}  // namespace

TEST_CASE(
    "[thesis] 6.3.1: bone in 10 s and muscles in 20 s come out in millimetres with gain 0.2") {
  const std::array<double, 3> expected_s = {9.6, 21.4, 20.8};
  for (std::size_t k = 0; k < 3; ++k) {
    const Outcome outcome = run(r1, table_6_1[k]);
    CHECK(std::abs(outcome.within_1_percent_s - expected_s[k]) < 0.3);
    CHECK(outcome.last_error < 1e-3);
  }
}

TEST_CASE(
    "[thesis] 6.3.1: with the printed gain of 5 the ten seconds need metres, for every tissue") {
  const std::array<double, 3> expected_s = {10.1, 10.7, 9.8};
  for (std::size_t k = 0; k < 3; ++k) {
    const Outcome outcome = run(r2, table_6_1[k]);
    CHECK(std::abs(outcome.within_5_percent_s - expected_s[k]) < 0.3);
    CHECK(outcome.last_error < 1e-3);
  }
}

TEST_CASE("a hundredth of a newton of noise breaks the simulated convergence of the thesis") {
  for (const TangentTissue& truth : table_6_1) {
    CHECK(run(r1, truth, 0.01).within_1_percent_s > 40.0);
    CHECK(run(r1, truth).within_1_percent_s < 22.0);
  }
}

TEST_CASE("with forgetting the covariance winds up in the air unless it is held") {
  for (const bool held : {false, true}) {
    ThesisEstimator hovered({.gain_per_s = 5.0, .only_in_contact = held});
    ThesisEstimator fresh({.gain_per_s = 5.0, .only_in_contact = held});
    for (int i = 0; i < 10000; ++i) hovered.update(1e-3 * i, {.depth_m = 0.0, .force_n = 0.0});
    const Press touch{.depth_m = 2e-3, .force_n = 5.0};
    hovered.update(10.0, touch);
    fresh.update(10.0, touch);
    const bool same =
        std::abs(hovered.estimate().tissue.alpha_n - fresh.estimate().tissue.alpha_n) < 1e-9;
    CHECK(same == held);
  }
}
