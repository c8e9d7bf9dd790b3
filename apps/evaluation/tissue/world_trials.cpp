// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/tissue/world_trials.hpp"

#include <algorithm>
#include <cmath>

#include "apps/evaluation/tissue/trials.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

constexpr double onset_n = 1.5, shown_n = 0.8;
constexpr std::size_t speed_over = 10;  // samples to either side

struct WorldRun {
  double error = 0.0, tangent_error = 0.0;
  bool held = false, converged = false;
};

WorldRun run_one(const sim::WorldPresses& presses) {
  tissue::CreepEstimator estimator;
  tissue::PressEstimator tangent;
  WorldRun run;
  const auto& [record, truth, last_press] = presses;
  const auto weaker = [](const tissue::TimedPress& a, const tissue::TimedPress& b) {
    return a.press.force_n < b.press.force_n;
  };
  const auto last = truth.begin() + static_cast<long>(last_press);
  const auto peak_at = std::max_element(last, truth.end(), weaker);
  const auto peak = static_cast<std::size_t>(peak_at - truth.begin());
  // Where presses follow without pause the last one begins at the lowest force.
  const auto begin =
      static_cast<std::size_t>(std::min_element(last, peak_at, weaker) - truth.begin());
  std::size_t onset = 0;
  for (; onset < peak; ++onset) {
    if (onset == last_press) run.converged = estimator.estimate().converged;
    estimator.update(record[onset].time_s, record[onset].press);
    tangent.update(record[onset].time_s, record[onset].press);
    if (onset > begin && record[onset].press.force_n >= onset_n) break;
  }
  estimator.settle();
  auto outlook = estimator.outlook();
  tissue::CreepEstimator::ForceBand told;
  for (std::size_t i = onset + 1; i <= peak; ++i) {
    const auto &before = truth[i - speed_over],
               &after = truth[std::min(i + speed_over, truth.size() - 1)];
    const double speed_m_per_s =
        (after.press.depth_m - before.press.depth_m) / (after.time_s - before.time_s);
    told = estimator.foretell(outlook, truth[i].time_s, truth[i].press.depth_m, speed_m_per_s);
  }
  const double peak_n = truth[peak].press.force_n;
  run.error = std::abs(told.force_n / peak_n - 1.0);
  const double felt_n = record[peak].press.force_n;
  run.held = told.low_n <= felt_n && felt_n <= told.high_n;
  // The tangent law finds the skin by the mean of the samples since the force showed.
  const TangentTissue& found = tangent.estimate().tissue;
  double skin_m = 0.0, samples = 0.0;
  for (std::size_t i = onset; samples == 0.0 || record[i].press.force_n > shown_n; --i) {
    skin_m += record[i].press.depth_m - tissue::depth_at_force(found, record[i].press.force_n);
    samples += 1.0;
  }
  skin_m /= samples;
  run.tangent_error =
      std::abs(tissue::force_at_depth(found, truth[peak].press.depth_m - skin_m) / peak_n - 1.0);
  return run;
}

}  // namespace

WorldResult run_world(const sim::TissueWorld& world, int runs, std::uint64_t seed, unsigned threads,
                      const Progress& progress) {
  const std::size_t cases = trial_tissues.size() * sim::ways_of_pressing.size();
  std::vector<WorldRun> all(cases * static_cast<std::size_t>(runs));
  const auto try_one = [&](std::size_t i) {
    Random random = make_random(seed + i, world.name);
    const sim::Pressing way = sim::ways_of_pressing[i % sim::ways_of_pressing.size()];
    const TrialTissue& tissue =
        trial_tissues[i / sim::ways_of_pressing.size() % trial_tissues.size()];
    all[i] = run_one(sim::press_in_world(world, way, tissue.tissue, random));
  };
  for_each_in_parallel(all.size(), try_one, progress, threads);
  WorldResult result{.runs = static_cast<int>(all.size())};
  std::vector<double> errors, tangent_errors;
  double held = 0.0, converged = 0.0, wrong = 0.0;
  for (const WorldRun& run : all) {
    errors.push_back(run.error);
    tangent_errors.push_back(run.tangent_error);
    held += run.held;
    converged += run.converged;
    wrong += run.converged && run.error > world_promise;
  }
  const auto n = static_cast<double>(all.size());
  result.median_error = quantile(errors, 0.5);
  result.p90_error = quantile(errors, 0.9);
  result.tangent_p90_error = quantile(tangent_errors, 0.9);
  result.coverage = held / n;
  result.converged_share = converged / n;
  result.wrong_share = converged > 0.0 ? wrong / converged : 0.0;
  return result;
}

telemetry::Table empty_world_table() {
  return {.note =
              "The force at the peak of a next press, foretold from the presses before and from "
              "where its skin is. Held: the sensor reads a force inside the band of 95 %. "
              "Converged: before that press; "
              "wrong: of these, more than 15 % off. Tangent: the law without memory.",
          .columns = {{.head = "world"},
                      {.head = "what", .key = "about"},
                      {.head = "presses", .key = "presses"},
                      {.head = "median, %", .key = "median_percent", .digits = 1},
                      {.head = "90 % below, %", .key = "p90_percent", .digits = 1},
                      {.head = "held, %", .key = "held_percent", .digits = 0},
                      {.head = "converged, %", .key = "converged_percent", .digits = 0},
                      {.head = "wrong, %", .key = "wrong_percent", .digits = 0},
                      {.head = "tangent 90 %", .key = "tangent_p90_percent", .digits = 0}}};
}

telemetry::Row row_of(const sim::TissueWorld& world, const WorldResult& result) {
  return {.cells = {world.name, world.about, result.runs, 100.0 * result.median_error,
                    100.0 * result.p90_error, 100.0 * result.coverage,
                    100.0 * result.converged_share, 100.0 * result.wrong_share,
                    100.0 * result.tangent_p90_error}};
}

}  // namespace tuina::app
