// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/tissue_trials.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "tuina/core/units.hpp"
#include "tuina/tissue/curve_fit.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/thesis_estimator.hpp"

namespace tuina::app {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double band = 0.05;

/// How one run went.
struct Run {
  double within_s = nan, first_press = nan, last = nan, alpha_error = nan;
  bool covers_alpha = false, covers_beta = false;
  double converged_s = nan;
  bool wrong = false;
};

struct Errors {
  double alpha, beta;
  [[nodiscard]] double worse() const { return std::max(std::abs(alpha), std::abs(beta)); }
};

Errors errors_of(const TangentTissue& found, const TangentTissue& truth) {
  return {found.alpha_n / truth.alpha_n - 1.0, found.beta_per_m / truth.beta_per_m - 1.0};
}

bool by_robot(const sim::PressScenario& s) {
  return s.shape == sim::PressScenario::Shape::force;
}

double first_press_ends_s(const sim::PressScenario& s) {
  return (by_robot(s) ? 0.9 : 0.0) + 1.0 / s.press_hz;
}

Run run_tuina(const sim::PressScenario& s, const sim::SimulatedPresses& presses) {
  tissue::PressEstimatorOptions options;
  if (by_robot(s)) {
    options = tissue::pressed_by_robot(s.torso_n_per_m, 0.0);
    options.force_delay_s = s.force_delay_s;
  }
  options.force_noise_n = s.force_noise_n;
  options.position_noise_m = s.position_noise_m;
  options.contact_sd_m = s.contact_sd_m;
  tissue::PressEstimator estimator(options);
  Run run;
  run.within_s = 0.0;
  for (const tissue::TimedPress& sample : presses.record) {
    estimator.update(sample.time_s, sample.press);
    const TissueEstimate& estimate = estimator.estimate();
    const Errors errors = errors_of(estimate.tissue, presses.truth);
    if (errors.worse() > band) run.within_s = sample.time_s + 1e-3;
    if (sample.time_s <= first_press_ends_s(s)) run.first_press = errors.worse();
    if (estimate.converged && std::isnan(run.converged_s)) {
      run.converged_s = estimate.converged_after_s;
      run.wrong = std::abs(errors.alpha) > options.converged_alpha ||
                  std::abs(errors.beta) > options.converged_beta;
    }
  }
  const TissueEstimate& estimate = estimator.estimate();
  const Errors errors = errors_of(estimate.tissue, presses.truth);
  run.last = errors.worse();
  run.alpha_error = errors.alpha;
  run.covers_alpha =
      std::abs(estimate.tissue.alpha_n - presses.truth.alpha_n) < estimate.alpha_ci95_n;
  run.covers_beta =
      std::abs(estimate.tissue.beta_per_m - presses.truth.beta_per_m) < estimate.beta_ci95_per_m;
  return run;
}

Run run_thesis(const sim::PressScenario& s, const sim::SimulatedPresses& presses, bool held) {
  tissue::ThesisEstimator estimator({.only_in_contact = held});
  Run run;
  run.within_s = 0.0;
  for (const tissue::TimedPress& sample : presses.record) {
    estimator.update(sample.press, 1e-3);
    const Errors errors = errors_of(estimator.tissue(), presses.truth);
    if (!(errors.worse() <= band)) run.within_s = sample.time_s + 1e-3;
    if (sample.time_s <= first_press_ends_s(s)) run.first_press = errors.worse();
    run.last = errors.worse();
    run.alpha_error = errors.alpha;
  }
  return run;
}

Run run_batch(const sim::PressScenario& s, const sim::SimulatedPresses& presses) {
  const tissue::SensorNoise noise{s.force_noise_n, s.position_noise_m};
  Run run;
  const auto first =
      std::min(presses.record.size(), static_cast<std::size_t>(first_press_ends_s(s) * 1e3));
  const std::span<const tissue::TimedPress> record(presses.record);
  if (const auto fit = tissue::fit_curve(record.first(first), noise)) {
    run.first_press = errors_of(fit->tissue, presses.truth).worse();
  }
  if (const auto fit = tissue::fit_curve(record, noise)) {
    const Errors errors = errors_of(fit->tissue, presses.truth);
    run.last = errors.worse();
    run.alpha_error = errors.alpha;
    run.covers_alpha = std::abs(fit->tissue.alpha_n - presses.truth.alpha_n) < fit->alpha_ci95_n;
    run.covers_beta =
        std::abs(fit->tissue.beta_per_m - presses.truth.beta_per_m) < fit->beta_ci95_per_m;
  }
  return run;
}

double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return nan;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

}  // namespace

const char* name_of(TrialMethod method) noexcept {
  switch (method) {
    case TrialMethod::tuina:
      return "tuina";
    case TrialMethod::thesis:
      return "thesis";
    case TrialMethod::thesis_held:
      return "thesis_held";
    case TrialMethod::batch:
      return "batch";
  }
  return "";
}

TrialResult run_trials(const sim::PressScenario& scenario, const TrialTissue& trial,
                       TrialMethod method, int runs, std::uint64_t seed, unsigned threads) {
  std::vector<Run> all(static_cast<std::size_t>(runs));
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      Random random = make_random(seed + i, scenario.name + trial.name);
      const auto presses = sim::simulate_presses(
          scenario, trial.tissue, by_robot(scenario) ? trial.robot_peak_n : trial.peak_n, random);
      all[i] = method == TrialMethod::tuina ? run_tuina(scenario, presses)
               : method == TrialMethod::batch
                   ? run_batch(scenario, presses)
                   : run_thesis(scenario, presses, method == TrialMethod::thesis_held);
    }
  };
  std::vector<std::thread> team;
  for (unsigned i = 1; i < threads; ++i) team.emplace_back(work);
  work();
  for (std::thread& thread : team) thread.join();

  const auto collect = [&](auto member) {
    std::vector<double> values;
    for (const Run& run : all) values.push_back(run.*member);
    return values;
  };
  TrialResult result{.runs = runs};
  const double n = static_cast<double>(runs);
  result.t95_s = quantile(collect(&Run::within_s), 0.95);
  if (result.t95_s >= scenario.duration_s - 1e-9)
    result.t95_s = std::numeric_limits<double>::infinity();
  result.first_press_q95 = quantile(collect(&Run::first_press), 0.95);
  result.last_q95 = quantile(collect(&Run::last), 0.95);
  double squares = 0.0;
  for (const Run& run : all) {
    result.alpha_bias += run.alpha_error / n;
    squares += run.alpha_error * run.alpha_error / n;
    result.coverage_alpha += run.covers_alpha / n;
    result.coverage_beta += run.covers_beta / n;
    result.converged_share += !std::isnan(run.converged_s) / n;
    result.false_converged_share += run.wrong / n;
  }
  result.detectable_change =
      2.77 * std::sqrt(std::max(0.0, squares - result.alpha_bias * result.alpha_bias));
  result.converged_median_s = quantile(collect(&Run::converged_s), 0.5);
  return result;
}

}  // namespace tuina::app
