// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tuina::history {
namespace {

constexpr double sd_of_95 = 1.959963984540054;
constexpr double max_false = 0.05;     // over all places of a session
constexpr int enough_differences = 8;  // to tell the scatter to about a quarter

struct LogStiffness {
  double mean = 0.0;
  double sd = 0.0;
};

/// By name of the place, of its last press.
std::map<std::string, LogStiffness> felt_in(const Visit& visit) {
  std::map<std::string, LogStiffness> felt;
  for (const VisitTissue& place : visit.tissue) {
    const double stiffness = place.stiffness_n_per_mm;
    const double sd = place.stiffness_ci95_n_per_mm / sd_of_95 / stiffness;
    if (!(stiffness > 0.0) || !std::isfinite(stiffness) || !(sd >= 0.0) || !std::isfinite(sd))
      continue;
    felt[place.name] = {std::log(stiffness), sd};
  }
  return felt;
}

struct Scatter {
  double sd = 0.0;
  double freedom = 0.0;
};

/// Two-sided probability of Student's t beyond `t`, by the normal deviate that is as rare,
/// [wallace1959].
double beyond(double t, double freedom) {
  if (!std::isfinite(freedom)) return std::erfc(t / std::sqrt(2.0));
  const double z = std::sqrt(freedom * std::log1p(t * t / freedom)) * (8.0 * freedom + 1.0) /
                   (8.0 * freedom + 3.0);
  return std::erfc(z / std::sqrt(2.0));
}

/// Scatter of the same places between sessions in a row beyond what their intervals explain. A
/// drift that all places share is a change of the person, not scatter, so it is taken off.
std::optional<Scatter> scatter_of(std::span<const Visit> visits) {
  double sum = 0.0;
  int freedom = 0;
  for (std::size_t i = 0; i + 1 < visits.size(); ++i) {
    const auto was = felt_in(visits[i]);
    const auto is = felt_in(visits[i + 1]);
    std::vector<double> steps;
    double explained = 0.0;
    for (const auto& [name, now] : is) {
      const auto then = was.find(name);
      if (then == was.end()) continue;
      steps.push_back(now.mean - then->second.mean);
      explained += now.sd * now.sd + then->second.sd * then->second.sd;
    }
    if (steps.size() < 2) continue;
    const auto count = static_cast<double>(steps.size());
    double mean = 0.0;
    for (const double step : steps) mean += step / count;
    for (const double step : steps) sum += (step - mean) * (step - mean);
    sum -= explained * (count - 1.0) / count;
    freedom += static_cast<int>(steps.size()) - 1;
  }
  if (freedom < enough_differences) return std::nullopt;
  // Each step has the scatter of two sessions. Two steps in a row share one of them, which leaves
  // two thirds of the freedom that as many independent steps would have.
  return Scatter{std::sqrt(std::max(0.0, sum / freedom / 2.0)), freedom * 2.0 / 3.0};
}

}  // namespace

double log_scatter(std::span<const Visit> visits) {
  const auto scatter = scatter_of(visits);
  return scatter ? std::max(scatter->sd, assumed_scatter) : assumed_scatter;
}

Changes changes_between(const Visit& before, const Visit& after, std::span<const Visit> earlier) {
  Changes changes;
  double freedom = std::numeric_limits<double>::infinity();
  if (const auto scatter = scatter_of(earlier)) {
    changes.scatter = scatter->sd;
    changes.scatter_assumed = false;
    freedom = scatter->freedom;
  }
  const auto was = felt_in(before);
  for (const auto& [name, now] : felt_in(after)) {
    const auto then = was.find(name);
    if (then == was.end()) continue;
    const double step = now.mean - then->second.mean;
    const double scattered = 2.0 * changes.scatter * changes.scatter;
    const double variance = now.sd * now.sd + then->second.sd * then->second.sd + scattered;
    const double sd = std::sqrt(variance);
    // The intervals are known, the scatter is an estimate, [satterthwaite1946].
    const double share = variance / scattered;
    changes.places.push_back({.name = name,
                              .before_n_per_mm = std::exp(then->second.mean),
                              .after_n_per_mm = std::exp(now.mean),
                              .change = std::expm1(step),
                              .low = std::expm1(step - sd_of_95 * sd),
                              .high = std::expm1(step + sd_of_95 * sd),
                              .p = beyond(std::abs(step) / sd, freedom * share * share)});
  }
  // The surest first; the k-th of n has to be surer than max_false / (n - k), and after one that is
  // not, no other counts.
  std::vector<PlaceChange*> by_p;
  for (PlaceChange& place : changes.places) by_p.push_back(&place);
  std::ranges::sort(by_p, {}, [](const PlaceChange* place) { return place->p; });
  for (std::size_t k = 0; k < by_p.size(); ++k) {
    if (by_p[k]->p > max_false / static_cast<double>(by_p.size() - k)) break;
    by_p[k]->real = true;
  }
  return changes;
}

}  // namespace tuina::history
