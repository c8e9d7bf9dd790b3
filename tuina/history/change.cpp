// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace tuina::history {
namespace {

constexpr double sd_of_95 = 1.959963984540054;
constexpr double max_false = 0.05;         // over all places of a session, and all together
constexpr double max_false_whole = 0.025;  // of these
constexpr int enough_differences = 8;      // to tell the scatter to about a quarter
constexpr std::size_t enough_places = 5;   // to tell how they differ
constexpr double shared_variance = 2.0 * assumed_shared_scatter * assumed_shared_scatter;
constexpr double min_sd = 1e-3;  // of a logarithm: no press tells more

/// What of a place is compared.
struct Quantity {
  double VisitTissue::*value;
  double VisitTissue::*ci95;
};
constexpr Quantity hardness{&VisitTissue::alpha_n, &VisitTissue::alpha_ci95_n};
constexpr Quantity stiffness{&VisitTissue::stiffness_n_per_mm,
                             &VisitTissue::stiffness_ci95_n_per_mm};

struct Logarithm {
  double mean = 0.0;
  double sd = 0.0;
};

/// By name of the place, of its last press.
std::map<std::string, Logarithm> felt_in(const Visit& visit, Quantity quantity) {
  std::map<std::string, Logarithm> felt;
  for (const VisitTissue& place : visit.tissue) {
    const double value = place.*quantity.value;
    const double sd = place.*quantity.ci95 / sd_of_95 / value;
    if (!(value > 0.0) || !std::isfinite(value) || !(sd >= 0.0) || !std::isfinite(sd)) continue;
    felt[place.name] = {std::log(value), std::max(sd, min_sd)};
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

/// Half width of the interval that holds 95 % of Student's t, by the same.
double half_of_95(double freedom) {
  if (!std::isfinite(freedom)) return sd_of_95;
  const double z = sd_of_95 * (8.0 * freedom + 3.0) / (8.0 * freedom + 1.0);
  return std::sqrt(freedom * std::expm1(z * z / freedom));
}

/// The session in the same position that comes after, and has felt something; nothing: none has.
const Visit* next_alike(std::span<const Visit> visits, std::size_t i) {
  for (std::size_t k = i + 1; k < visits.size(); ++k)
    if (!visits[k].tissue.empty() && visits[k].position == visits[i].position) return &visits[k];
  return nullptr;
}

/// Scatter of the same places between sessions in a row beyond what their intervals explain. A
/// drift that all places share is a change of the person, not scatter, so it is taken off.
std::optional<Scatter> scatter_of(std::span<const Visit> visits, Quantity quantity,
                                  const std::string* position) {
  double sum = 0.0;
  int freedom = 0;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    if (position != nullptr && visits[i].position != *position) continue;
    const Visit* next = next_alike(visits, i);
    if (next == nullptr) continue;
    const auto was = felt_in(visits[i], quantity);
    const auto is = felt_in(*next, quantity);
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

/// A step of the logarithm of one place between two sessions.
struct Step {
  double mean = 0.0;
  double variance = 0.0;
};

/// Where no earlier sessions tell the scatter: what is assumed, or what the places other than
/// `but_for` show by how their steps differ, if that is more.
Scatter assumed_or_seen(std::span<const Step> steps, std::size_t but_for) {
  double count = 0.0, mean = 0.0, explained = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i == but_for) continue;
    count += 1.0;
    mean += (steps[i].mean - mean) / count;
    explained += (steps[i].variance - explained) / count;
  }
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (i != but_for) spread += (steps[i].mean - mean) * (steps[i].mean - mean);
  const double seen = (spread / (count - 1.0) - explained) / 2.0;
  if (count - 1.0 >= enough_differences && seen > assumed_scatter * assumed_scatter)
    return {std::sqrt(seen), count - 1.0};
  return {assumed_scatter, std::numeric_limits<double>::infinity()};
}

Change change_of(std::string name, double before_n, Step step, double freedom) {
  const double sd = std::sqrt(step.variance), half = half_of_95(freedom) * sd;
  return {.name = std::move(name),
          .before_n = before_n,
          .after_n = before_n * std::exp(step.mean),
          .change = std::expm1(step.mean),
          .low = std::expm1(step.mean - half),
          .high = std::expm1(step.mean + half),
          .p = beyond(std::abs(step.mean) / sd, freedom)};
}

/// What the places share. Each counts the more, the surer it is; that their errors are as large as
/// was told is not believed but seen in how they differ.
std::optional<Change> change_of_whole(std::span<const Change> places, std::span<const Step> steps) {
  if (steps.size() < enough_places) return std::nullopt;
  const double freedom = static_cast<double>(steps.size()) - 1.0;
  double weights = 0.0, mean = 0.0, before = 0.0, spread = 0.0;
  for (const Step& step : steps) weights += 1.0 / step.variance;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double share = 1.0 / (steps[i].variance * weights);
    mean += share * steps[i].mean;
    before += share * std::log(places[i].before_n);
  }
  for (const Step& step : steps) {
    const double off = step.mean - mean;
    spread += off * off / (step.variance * weights * freedom);
  }
  return change_of("", std::exp(before), {mean, spread + shared_variance}, freedom);
}

/// The surest first; the k-th of n has to be surer than `max` / (n - k), and after one that is not,
/// no other counts.
void call_real(std::vector<Change>& places, double max) {
  std::vector<Change*> by_p;
  by_p.reserve(places.size());
  for (Change& place : places) by_p.push_back(&place);
  std::ranges::sort(by_p, {}, [](const Change* place) { return place->p; });
  for (std::size_t k = 0; k < by_p.size(); ++k) {
    if (by_p[k]->p > max / static_cast<double>(by_p.size() - k)) break;
    by_p[k]->real = true;
  }
}

}  // namespace

double log_scatter(std::span<const Visit> visits) {
  const auto scatter = scatter_of(visits, stiffness, nullptr);
  return scatter ? std::max(scatter->sd, assumed_scatter) : assumed_scatter;
}

Changes changes_between(const Visit& before, const Visit& after, std::span<const Visit> earlier) {
  Changes changes;
  std::vector<Step> steps;
  const auto was = felt_in(before, hardness);
  for (const auto& [name, now] : felt_in(after, hardness)) {
    const auto then = was.find(name);
    if (then == was.end()) continue;
    steps.push_back(
        {now.mean - then->second.mean, now.sd * now.sd + then->second.sd * then->second.sd});
    changes.places.push_back({.name = name, .before_n = std::exp(then->second.mean)});
  }
  const auto told = scatter_of(earlier, hardness, &after.position);
  changes.scatter = told ? told->sd : assumed_or_seen(steps, steps.size()).sd;
  changes.scatter_assumed = !told;
  std::vector<Step> wider;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Scatter scatter = told ? *told : assumed_or_seen(steps, i);
    const double scattered = 2.0 * scatter.sd * scatter.sd;
    wider.push_back({steps[i].mean, steps[i].variance + scattered + shared_variance});
    // What steps show is the sum of scatter and errors, so the sum is as sure as it is.
    Change& place = changes.places[i];
    place = change_of(place.name, place.before_n, wider[i], scatter.freedom);
  }
  steps = std::move(wider);
  changes.whole = change_of_whole(changes.places, steps);
  const bool all = changes.whole && changes.whole->p <= max_false_whole;
  if (changes.whole) changes.whole->real = all;
  const bool shares = changes.whole && !all;
  call_real(changes.places, shares ? max_false - max_false_whole : max_false);
  return changes;
}

}  // namespace tuina::history
