// SPDX-License-Identifier: Apache-2.0
// Cost of one millisecond of estimation, beside the thesis' least squares and a whole batch fit.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "tuina/baselines/thesis_estimator.hpp"
#include "tuina/sim/press_scenarios.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/curve_fit.hpp"
#include "tuina/tissue/press_estimator.hpp"

using namespace tuina;

namespace {

const std::vector<tissue::TimedPress>& record() {
  static const auto presses = [] {
    Random random = make_random(1, "bench");
    return sim::simulate_presses(sim::press_scenarios().front(), {9.786, 185.4}, 60.0, random)
        .record;
  }();
  return presses;
}

template <tissue::Estimator Estimator>
void per_sample(benchmark::State& state) {
  for (auto _ : state) {
    Estimator estimator(typename Estimator::Options{});
    for (const auto& sample : record()) estimator.update(sample.time_s, sample.press);
    benchmark::DoNotOptimize(estimator.estimate());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<long>(record().size()));
}
BENCHMARK(per_sample<tissue::PressEstimator>);
BENCHMARK(per_sample<tissue::CreepEstimator>);
BENCHMARK(per_sample<baselines::ThesisEstimator>);

/// Not a mean but the slowest tick of a thousand, each timed on its own.
template <tissue::Estimator Estimator>
void slowest_of_1000(benchmark::State& state) {
  std::vector<double> ticks_us;
  for (auto _ : state) {
    Estimator estimator(typename Estimator::Options{});
    for (const auto& sample : record()) {
      const auto start = std::chrono::steady_clock::now();
      estimator.update(sample.time_s, sample.press);
      ticks_us.push_back(
          std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
              .count());
    }
  }
  std::sort(ticks_us.begin(), ticks_us.end());
  state.counters["tick_999_us"] = ticks_us[ticks_us.size() * 999 / 1000];
}
BENCHMARK(slowest_of_1000<tissue::PressEstimator>)->Iterations(50);
BENCHMARK(slowest_of_1000<tissue::CreepEstimator>)->Iterations(50);

void batch_fit_1000_samples(benchmark::State& state) {
  const std::span<const tissue::TimedPress> press(record().data(), 1000);
  for (auto _ : state) benchmark::DoNotOptimize(tissue::fit_curve(press, tissue::SensorNoise{}));
}
BENCHMARK(batch_fit_1000_samples)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
