// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/depth_rules.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/press_scenarios.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue bone{4.559, 263.2}, hard{9.786, 185.4}, soft{4.275, 143.6};

/// A converged estimate of the truth, `errors` standard deviations off in alpha and beta.
TissueEstimate estimate_of(const TangentTissue& truth, double alpha_errors = 0.0,
                           double beta_errors = 0.0) {
  constexpr double sd = 0.02;
  TissueEstimate estimate;
  estimate.tissue = {truth.alpha_n * (1.0 + alpha_errors * sd),
                     truth.beta_per_m * (1.0 + beta_errors * sd)};
  estimate.alpha_ci95_n = 1.96 * sd * estimate.tissue.alpha_n;
  estimate.beta_ci95_per_m = 1.96 * sd * estimate.tissue.beta_per_m;
  estimate.presses = 2;
  estimate.converged = true;
  return estimate;
}

const sim::PressScenario& scenario(const std::string& name) {
  for (const auto& known : sim::press_scenarios()) {
    if (known.name == name) return known;
  }
  FAIL("no such scenario: " << name);
  return sim::press_scenarios().front();
}

/// By an estimator that is told how good the sensors are.
TissueEstimate felt(const std::vector<TimedPress>& record, double until_s,
                    const sim::PressScenario& by = {}) {
  PressEstimator estimator({.force_noise_n = by.force_noise_n,
                            .position_noise_m = by.position_noise_m,
                            .contact_sd_m = by.contact_sd_m});
  for (const TimedPress& sample : record) {
    if (sample.time_s < until_s) estimator.update(sample.time_s, sample.press);
  }
  return estimator.estimate();
}

}  // namespace

TEST_CASE(
    "A1: probing ends within two and a half seconds, below order and region, and half way up") {
  for (const std::string name : {"N0", "N1", "N2", "N3", "N4", "N6"}) {
    for (const TangentTissue& tissue : {bone, hard, soft}) {
      for (const double cap_n : {20.0, 45.0}) {
        CAPTURE(name);
        Random random = make_random(3, name);
        TissueEstimate estimate;
        double time_s = 0.0, peak_n = 0.0;
        constexpr double ordered_n = 20.0;
        while (!probed_enough(estimate, peak_n, ordered_n, cap_n) && time_s < 10.0) {
          peak_n = probing_force_n(estimate, ordered_n, cap_n);
          CHECK(peak_n <= ordered_n);
          CHECK(peak_n <= (estimate.presses == 0 ? 8.0 : std::max(0.5 * cap_n, 0.7 * ordered_n)));
          time_s += 1.0;
          const auto presses = sim::simulate_presses(scenario(name), tissue, peak_n, random);
          // Seen by the next press: what the tissue is, after as many presses as were made.
          estimate = felt(presses.record, time_s, scenario(name));
        }
        CHECK(time_s <= 2.5);
        CHECK(peak_n >= 0.7 * ordered_n);
      }
    }
  }
}

TEST_CASE("A1: a light order is never probed with more than itself") {
  CHECK(probing_force_n({}, 6.0, 45.0) == 6.0);
  CHECK(probing_force_n(estimate_of(hard), 6.0, 45.0) == 6.0);
}

TEST_CASE("A1: a probe reaches seven tenths of an order of nearly all that the place may bear") {
  CHECK(probing_force_n({}, 19.0, 20.0) == 8.0);
  CHECK(probing_force_n(estimate_of(soft), 19.0, 20.0) == doctest::Approx(0.7 * 19.0));
}

TEST_CASE(
    "A1: where little may be ordered the probe still stands out from the touch that is kept") {
  CHECK(probing_force_n({}, 8.0, 10.0) == 7.0);
  CHECK(probing_force_n(estimate_of(hard), 8.0, 10.0) == 7.0);
  CHECK(probing_force_n({}, 8.0, 6.0) == 6.0);
}

TEST_CASE("tissue of another law, or an estimate not converged, is no ground for anything") {
  TissueEstimate estimate = estimate_of(hard);
  CHECK(may_steer(estimate, 1.0));
  CHECK_FALSE(may_steer(estimate, 4.5));
  CHECK_FALSE(may_steer(estimate, std::numeric_limits<double>::quiet_NaN()));
  estimate.converged = false;
  CHECK_FALSE(may_steer(estimate, 1.0));
}

TEST_CASE("A2: nobody is pressed more than twice as hard as before unless it is well foretold") {
  CHECK(firmest_next_n(Foretold::well, 8.0, 28.0) == 28.0);
  CHECK(firmest_next_n(Foretold::loosely, 8.0, 28.0) == 16.0);
  CHECK(firmest_next_n(Foretold::loosely, 20.0, 28.0) == 28.0);
  CHECK(firmest_next_n(Foretold::wrongly, 8.0, 28.0) == 8.0);
  CHECK(firmest_next_n(Foretold::wrongly, 40.0, 28.0) == 28.0);
}

TEST_CASE("A5: the impedance is half as stiff as the tissue, within its limits") {
  CHECK(impedance_for(4000.0, 1.0).stiffness_n_per_m == 2000.0);
  CHECK(impedance_for(1e6, 1.0).stiffness_n_per_m == 3000.0);
  CHECK(impedance_for(10.0, 1.0).stiffness_n_per_m == 200.0);
  CHECK(std::isfinite(impedance_for(std::nan(""), 1.0).damping_n_s_per_m));
}

TEST_CASE("A6: from soft to stiff the share rises without chatter, and noise does not move it") {
  ControlShare control;
  int changes = 0;
  double before = 0.0;
  Random random = make_random(1, "share");
  for (double t = 0.0; t < 20.0; t += 1e-3) {
    const double k = 500.0 * std::pow(100.0, t / 20.0) * std::exp(gaussian(random, 0.05));
    const double share = control.step(k, 1e-3, 1e-3);
    CHECK_FALSE(share < before - 0.12);
    changes += share != before;
    before = share;
  }
  CHECK(changes <= 15);
  CHECK(control.share() == 1.0);
  ControlShare moving;
  for (int i = 0; i < 1000; ++i) moving.step(50e3, 10e-3, 1e-3);
  CHECK(moving.share() == 0.0);  // never while the tool moves
}

TEST_CASE("A7: dwelling ends soon after a tenth of softening, and honestly where there is none") {
  for (const bool softens : {true, false}) {
    Random random = make_random(2, "dwell");
    std::vector<PressSet> sets;
    Dwell dwell = Dwell::go_on;
    double elapsed_s = 0.0, truth_s = -1.0;
    const double change_at_first = -0.2 * (1.0 - std::exp(-6.0 / 30.0));
    while (dwell == Dwell::go_on) {
      elapsed_s += 6.0;
      const double change = softens ? -0.2 * (1.0 - std::exp(-elapsed_s / 30.0)) : 0.0;
      if (softens && truth_s < 0.0 && change < change_at_first - 0.1) truth_s = elapsed_s;
      sets.push_back({change + gaussian(random, 0.003), 0.003});
      dwell = dwell_after(sets, elapsed_s);
    }
    CHECK(dwell == (softens ? Dwell::softened : Dwell::no_change));
    if (softens) CHECK(std::abs(elapsed_s - truth_s) <= 12.0);
    if (!softens) CHECK(elapsed_s <= 30.0);
  }
  const PressSet set{0.0, 0.0};
  CHECK(dwell_after(std::vector<PressSet>{set, {-0.05, 0.0}}, 90.0) == Dwell::time_up);
}

TEST_CASE("A9: a person who tenses is noticed within one press, one who does not is left alone") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    int false_alarms = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Random random = make_random(seed, "guarding");
      const auto before = sim::simulate_presses(scenario("N0"), tissue, 20.0, random);
      const TissueEstimate reference = felt(before.record, 6.0);
      const auto calm = sim::simulate_presses(scenario("N0"), tissue, 20.0, random);
      const TangentTissue tense{1.4 * tissue.alpha_n, tissue.beta_per_m};
      const auto tensed = sim::simulate_presses(scenario("N0"), tense, 20.0, random);
      false_alarms += compare(reference, felt(calm.record, 1.05), 10.0) != Alarm::none;
      CHECK(compare(reference, felt(tensed.record, 1.05), 10.0) == Alarm::guarding);
    }
    CHECK(false_alarms == 0);
  }
  TissueEstimate moved = estimate_of(soft);
  moved.contact_m = 4_mm;
  CHECK(compare(estimate_of(soft), moved, 10.0) == Alarm::moved);
}
