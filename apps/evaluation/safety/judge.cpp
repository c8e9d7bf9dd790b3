// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tuina::app {
namespace {

constexpr double max_free_m_per_s =
    0.25;  // an arm that leaves or drifts is not faster than one that travels
constexpr double let_go_n = 5.0;  // a tool that lies on the skin weighs no more

void judge_force(const Promise& promise, const TrialOutcome& outcome,
                 std::vector<std::string>& broken) {
  const double max_n = allowed_n(promise, outcome.set_force_n);
  if (outcome.worst_force_n > max_n)
    broken.push_back(fmt::format("{:.0f} N, {:.0f} allowed", outcome.worst_force_n, max_n));
  if (outcome.over_seldom_s > seldom_s + 1e-9)
    broken.push_back(fmt::format("above {:.0f} N for {:.0f} ms, {:.0f} allowed", seldom_n,
                                 1e3 * outcome.over_seldom_s, 1e3 * seldom_s));
  if (promise.further_mm && 1e3 * outcome.further_m > *promise.further_mm)
    broken.push_back(fmt::format("{:.1f} mm further into the body, {:g} allowed",
                                 1e3 * outcome.further_m, *promise.further_mm));
  if (promise.apart_mm && 1e3 * outcome.apart_m < *promise.apart_mm)
    broken.push_back(fmt::format("{:.0f} mm from what it must not touch, {:g} wanted",
                                 1e3 * outcome.apart_m, *promise.apart_mm));
  if (promise.rmse_n && !outcome.stopped && outcome.rmse_n > *promise.rmse_n)
    broken.push_back(
        fmt::format("force {:.1f} N rms off, {:g} allowed", outcome.rmse_n, *promise.rmse_n));
}

void judge_stop(const Promise& promise, Stage stage, const TrialOutcome& outcome,
                std::vector<std::string>& broken) {
  const bool must = promise.duty == Duty::stop;
  if (std::isnan(outcome.first_action_ms)) {
    if (must) broken.emplace_back("nothing acts");
    return;
  }
  if (must && promise.act_ms && outcome.first_action_ms > *promise.act_ms + 1e-6)
    broken.push_back(fmt::format("acts after {:.0f} ms, {:g} allowed", outcome.first_action_ms,
                                 *promise.act_ms));
  if (!outcome.stopped) return;
  const auto& causes = promise.causes;
  if (!causes.empty() && std::find(causes.begin(), causes.end(), outcome.cause) == causes.end())
    broken.push_back(fmt::format("called '{}'", outcome.cause));
  if (outcome.end_force_n > let_go_n)
    broken.push_back(fmt::format("still presses {:.0f} N", outcome.end_force_n));
  if (outcome.end_m_per_s > max_free_m_per_s)
    broken.push_back(fmt::format("still moves at {:.2f} m/s", outcome.end_m_per_s));
  if (promise.released_ms && stage == Stage::contact && outcome.released_ms > *promise.released_ms)
    broken.push_back(fmt::format("on the skin for {:.0f} ms, {:g} allowed", outcome.released_ms,
                                 *promise.released_ms));
}

/// Probability of at most `violations` in `runs` with this share, summed in logarithms.
double binomial_tail(std::size_t violations, std::size_t runs, double share) {
  const double n = static_cast<double>(runs);
  double sum = 0.0;
  for (std::size_t i = 0; i <= violations; ++i) {
    const double k = static_cast<double>(i);
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                    k * std::log(share) + (n - k) * std::log1p(-share));
  }
  return sum;
}

}  // namespace

double allowed_n(const Promise& promise, double set_force_n) {
  double max_n = never_n;
  if (promise.over_set_n) max_n = std::min(max_n, set_force_n + *promise.over_set_n);
  if (promise.highest_n) max_n = std::min(max_n, *promise.highest_n);
  return max_n;
}

std::vector<std::string> broken_promises(const FaultClass& fault, Stage stage,
                                         const TrialOutcome& outcome) {
  std::vector<std::string> broken;
  if (!outcome.tried) return {fmt::format("stopped before the fault came: '{}'", outcome.cause)};
  judge_force(fault.promise, outcome, broken);
  if (outcome.end == "beyond all bounds") broken.push_back(outcome.end);
  if (fault.promise.duty == Duty::ride && outcome.stopped) {
    broken.push_back(fmt::format("stopped without need: '{}'", outcome.cause));
  } else if (fault.promise.duty != Duty::ride) {
    judge_stop(fault.promise, stage, outcome, broken);
  }
  return broken;
}

double clopper_pearson_upper(std::size_t violations, std::size_t runs, double confidence) {
  if (violations >= runs) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {  // halves to the last digit of a double
    const double share = 0.5 * (low + high);
    (binomial_tail(violations, runs, share) > 1.0 - confidence ? low : high) = share;
  }
  return high;
}

}  // namespace tuina::app
