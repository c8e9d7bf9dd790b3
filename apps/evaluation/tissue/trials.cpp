// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/tissue/trials.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "tuina/baselines/kalman_estimator.hpp"
#include "tuina/baselines/thesis_estimator.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/curve_fit.hpp"
#include "tuina/tissue/press_estimator.hpp"

namespace tuina::app {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double band = 0.05;
constexpr double loop_torso_n_per_m = 35e3;

/// One record with its truth and what an estimator is told beforehand.
struct Trial {
  std::vector<tissue::TimedPress> record;
  TangentTissue truth;
  double skin_m = 0.0;   // the true one, for the method that is told it
  double begin_s = 0.0;  // times of results count from here
  double first_press_s = 0.0;
  tissue::PressEstimatorOptions options;
};

/// How one method fared on one trial.
struct Run {
  double within_s = nan, first_press = nan, last = nan, alpha_error = nan, beta_error = nan;
  bool covers_alpha = false, covers_beta = false, kept = false;
  double converged_s = nan;
  bool wrong = false;
  std::vector<double> curve;
};

struct Errors {
  double alpha, beta;
  [[nodiscard]] double worse() const { return std::max(std::abs(alpha), std::abs(beta)); }
};

Errors errors_of(const TangentTissue& found, const TangentTissue& truth) {
  return {found.alpha_n / truth.alpha_n - 1.0, found.beta_per_m / truth.beta_per_m - 1.0};
}

void finish(Run& run, const Trial& trial, const TissueEstimate& estimate) {
  const Errors errors = errors_of(estimate.tissue, trial.truth);
  run.last = errors.worse();
  run.alpha_error = errors.alpha;
  run.beta_error = errors.beta;
  run.covers_alpha =
      std::abs(estimate.tissue.alpha_n - trial.truth.alpha_n) < estimate.alpha_ci95_n;
  run.covers_beta =
      std::abs(estimate.tissue.beta_per_m - trial.truth.beta_per_m) < estimate.beta_ci95_per_m;
  run.kept = std::abs(errors.alpha) <= trial.options.converged_alpha &&
             std::abs(errors.beta) <= trial.options.converged_beta;
}

/// `update` takes a sample and gives the estimate after it.
template <typename Update>
Run run_online(const Trial& trial, const Update& update) {
  Run run;
  run.within_s = 0.0;
  TissueEstimate estimate;
  for (const tissue::TimedPress& sample : trial.record) {
    estimate = update(sample);
    const double time_s = sample.time_s - trial.begin_s;
    const Errors errors = errors_of(estimate.tissue, trial.truth);
    if (!(errors.worse() <= band)) run.within_s = time_s + 1e-3;
    if (time_s <= trial.first_press_s) run.first_press = errors.worse();
    if (time_s >= static_cast<double>(run.curve.size()) * curve_step_s)
      run.curve.push_back(errors.worse());
    if (estimate.converged && std::isnan(run.converged_s)) {
      run.converged_s = estimate.converged_after_s;
      run.wrong = std::abs(errors.alpha) > trial.options.converged_alpha ||
                  std::abs(errors.beta) > trial.options.converged_beta;
    }
  }
  finish(run, trial, estimate);
  if (!(run.last <= band)) run.within_s = infinity;
  return run;
}

Run run_thesis(const Trial& trial, const baselines::ThesisEstimatorOptions& options,
               double skin_m) {
  baselines::ThesisEstimator estimator(options);
  return run_online(trial, [&](const tissue::TimedPress& sample) {
    estimator.update(sample.time_s, {sample.press.depth_m - skin_m, sample.press.force_n});
    return estimator.estimate();
  });
}

/// Five samples to one: a fit does not lose by it, and takes a fifth of the time.
std::vector<tissue::TimedPress> fives(std::span<const tissue::TimedPress> record) {
  std::vector<tissue::TimedPress> means;
  for (std::size_t i = 0; i + 5 <= record.size(); i += 5) {
    tissue::TimedPress mean;
    for (std::size_t k = i; k < i + 5; ++k) {
      mean.time_s += record[k].time_s / 5.0;
      mean.press.depth_m += record[k].press.depth_m / 5.0;
      mean.press.force_n += record[k].press.force_n / 5.0;
    }
    means.push_back(mean);
  }
  return means;
}

Run run_batch(const Trial& trial) {
  const tissue::SensorNoise noise{trial.options.force_noise_n / std::sqrt(5.0),
                                  trial.options.position_noise_m / std::sqrt(5.0)};
  const std::vector<tissue::TimedPress> record = fives(trial.record);
  Run run;
  const auto first = static_cast<std::size_t>(
      std::count_if(record.begin(), record.end(), [&](const tissue::TimedPress& sample) {
        return sample.time_s - trial.begin_s <= trial.first_press_s;
      }));
  if (const auto fit = tissue::fit_curve(std::span(record).first(first), noise))
    run.first_press = errors_of(fit->tissue, trial.truth).worse();
  if (const auto fit = tissue::fit_curve(record, noise))
    finish(run, trial, {fit->tissue, fit->alpha_ci95_n, fit->beta_ci95_per_m});
  return run;
}

Run run_method(TrialMethod method, const Trial& trial) {
  switch (method) {
    case TrialMethod::tuina: {
      tissue::PressEstimator estimator(trial.options);
      return run_online(trial, [&](const tissue::TimedPress& sample) {
        estimator.update(sample.time_s, sample.press);
        return estimator.estimate();
      });
    }
    case TrialMethod::thesis:
      return run_thesis(trial, {}, 0.0);
    case TrialMethod::thesis_tuned:
      return run_thesis(trial,
                        {.gain_per_s = 0.1, .initial_covariance = 1e3, .only_in_contact = true},
                        trial.skin_m);
    case TrialMethod::kalman: {
      baselines::KalmanEstimator estimator({.force_noise_n = trial.options.force_noise_n,
                                            .position_noise_m = trial.options.position_noise_m,
                                            .contact_sd_m = trial.options.contact_sd_m});
      return run_online(trial, [&](const tissue::TimedPress& sample) {
        estimator.update(sample.time_s, sample.press);
        return estimator.estimate();
      });
    }
    case TrialMethod::batch:
      return run_batch(trial);
  }
  return {};
}

TrialResult summarise(const std::vector<Run>& all) {
  const auto collect = [&](auto member) {
    std::vector<double> values;
    values.reserve(all.size());
    for (const Run& run : all) values.push_back(run.*member);
    return values;
  };
  TrialResult result{.runs = static_cast<int>(all.size())};
  const double n = static_cast<double>(all.size());
  result.t95_s = quantile(collect(&Run::within_s), 0.95);
  result.first_press_q95 = quantile(collect(&Run::first_press), 0.95);
  result.last_q95 = quantile(collect(&Run::last), 0.95);
  double squares = 0.0;
  for (const Run& run : all) {
    result.alpha_bias += run.alpha_error / n;
    result.beta_bias += run.beta_error / n;
    squares += run.alpha_error * run.alpha_error / n;
    result.coverage_alpha += run.covers_alpha / n;
    result.coverage_beta += run.covers_beta / n;
    result.converged_share += !std::isnan(run.converged_s) / n;
    result.false_converged_share += run.wrong / n;
    result.kept_share += run.kept / n;
  }
  result.detectable_change =
      2.77 * std::sqrt(std::max(0.0, squares - result.alpha_bias * result.alpha_bias));
  result.converged_median_s = quantile(collect(&Run::converged_s), 0.5);
  for (std::size_t k = 0;; ++k) {
    std::vector<double> errors;
    for (const Run& run : all) {
      if (k < run.curve.size()) errors.push_back(run.curve[k]);
    }
    if (2 * errors.size() <= all.size()) break;  // records end at different times
    result.worse_q95.push_back(quantile(errors, 0.95));
  }
  return result;
}

/// A fit of all samples takes a hundred times as long as the others; a quarter shows as much.
constexpr std::size_t one_batch_in = 4;

/// Makes `runs` trials on `threads` threads and runs every method on each. A trial that came to
/// nothing has an empty record and is left out.
TrialResults run_all(int runs, unsigned threads, const Progress& progress,
                     const std::function<Trial(std::size_t)>& make) {
  std::vector<std::array<std::optional<Run>, trial_methods.size()>> all(
      static_cast<std::size_t>(runs));
  const auto try_all = [&](std::size_t i) {
    const Trial trial = make(i);
    for (std::size_t m = 0; m < trial_methods.size() && !trial.record.empty(); ++m) {
      if (trial_methods[m] == TrialMethod::batch && i % one_batch_in != 0) continue;
      all[i][m] = run_method(trial_methods[m], trial);
    }
  };
  for_each_in_parallel(all.size(), try_all, progress, threads);
  TrialResults results;
  for (std::size_t m = 0; m < trial_methods.size(); ++m) {
    std::vector<Run> done_runs;
    for (const auto& methods : all) {
      if (methods[m]) done_runs.push_back(*methods[m]);
    }
    results[m] = summarise(done_runs);
  }
  return results;
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return nan;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

const char* name_of(TrialMethod method) noexcept {
  switch (method) {
    case TrialMethod::tuina:
      return "tuina";
    case TrialMethod::thesis:
      return "thesis";
    case TrialMethod::thesis_tuned:
      return "thesis_tuned";
    case TrialMethod::kalman:
      return "kalman";
    case TrialMethod::batch:
      return "batch";
  }
  return "";
}

TrialResults run_trials(const sim::PressScenario& s, const TrialTissue& tissue, int runs,
                        std::uint64_t seed, unsigned threads, const Progress& progress) {
  const bool by_robot = s.shape == sim::PressScenario::Shape::force;
  return run_all(runs, threads, progress, [&](std::size_t i) {
    Random random = make_random(seed + i, s.name + tissue.name);
    sim::SimulatedPresses presses = sim::simulate_presses(
        s, tissue.tissue, by_robot ? tissue.robot_peak_n : tissue.peak_n, random);
    Trial trial{.record = std::move(presses.record),
                .truth = presses.truth,
                .skin_m = presses.skin_m,
                .first_press_s = (by_robot ? 0.9 : 0.0) + 1.0 / s.press_hz,
                .options = {}};
    if (by_robot) {
      trial.options = tissue::pressed_by_robot(s.torso_n_per_m, 0.0);
      trial.options.force_delay_s = s.force_delay_s;
    }
    trial.options.force_noise_n = s.force_noise_n;
    trial.options.position_noise_m = s.position_noise_m;
    trial.options.contact_sd_m = s.contact_sd_m;
    return trial;
  });
}

const std::vector<LoopScenario>& loop_scenarios() {
  constexpr massage::PressWindow second{.edge_s = 0.4, .hold_s = 0.05, .steepness = 4.0};
  static const std::vector<LoopScenario> all = {
      {"arm_1Hz", "two presses of a second by the simulated arm", second},
      {"arm_still", "the same, breath held", second, 0.0},
      {"arm_0.4Hz_breath", "the same, breathing faster than expected", second, 3_mm, 0.4},
      {"arm_massage", "two presses as a massage makes them, of 3.8 s", {}},
  };
  return all;
}

Result<TrialResults> run_loop_trials(const LoopScenario& scenario, const TrialTissue& tissue,
                                     int runs, std::uint64_t seed, unsigned threads,
                                     const Progress& progress) {
  std::mutex failing;
  std::optional<Error> failed;
  const double press_s = 2.0 * scenario.window.edge_s + scenario.window.hold_s + 0.2;
  const auto make = [&](std::size_t i) {
    Random random = make_random(seed + i, scenario.name + tissue.name);
    ContactExperiment experiment;
    experiment.tissue = {tissue.tissue.alpha_n * std::exp(gaussian(random, 0.15)),
                         tissue.tissue.beta_per_m * std::exp(gaussian(random, 0.08))};
    experiment.window = scenario.window;
    experiment.force_n = uniform(random, 20.0, 30.0);
    experiment.torso_n_per_m = loop_torso_n_per_m * (1.0 + uniform(random, -0.2, 0.2));
    experiment.surface_error_m = uniform(random, -3_mm, 3_mm);
    experiment.breathing = {scenario.breath_m, scenario.breath_hz};
    experiment.duration_s = 2.0 * press_s + 1.1;  // two presses, landing and leaving
    experiment.seed = random();
    auto outcome = run_contact(experiment);
    Trial trial;
    if (!outcome) {
      const std::lock_guard lock(failing);
      failed = outcome.error();
      return trial;
    }
    if (outcome->stopped) return trial;  // the guard ended it; `runs` tells how many were left
    trial.record = std::move(outcome->felt);
    trial.truth = experiment.tissue;
    trial.options = tissue::pressed_by_robot(loop_torso_n_per_m, robot::thesis_arm().tool_mass_kg);
    const auto touch =
        std::find_if(outcome->trace.begin(), outcome->trace.end(),
                     [](const ContactSample& sample) { return sample.true_force_n > 0.0; });
    if (touch != outcome->trace.end()) trial.begin_s = touch->time_s;
    const auto at = std::lower_bound(
        trial.record.begin(), trial.record.end(), trial.begin_s,
        [](const tissue::TimedPress& sample, double time_s) { return sample.time_s < time_s; });
    if (at != trial.record.end()) trial.skin_m = at->press.depth_m;
    // The force is landed for half a second before the first press begins.
    trial.first_press_s = 0.7 + press_s;
    return trial;
  };
  TrialResults results = run_all(runs, threads, progress, make);
  if (failed) return tl::unexpected(*failed);
  return results;
}

}  // namespace tuina::app
