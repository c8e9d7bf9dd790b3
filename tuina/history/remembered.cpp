// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/remembered.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/history/change.hpp"

namespace tuina::history {
namespace {

template <typename Wanted>
const Visit* newest(std::span<const Visit> visits, const Wanted& wanted) {
  const auto found = std::find_if(visits.rbegin(), visits.rend(),
                                  [&](const Visit& visit) { return visit.ended && wanted(visit); });
  return found == visits.rend() ? nullptr : &*found;
}

bool lay(const Visit& visit, std::optional<BodyPosture> position) {
  return !position || visit.position == name_of(*position);
}

session::KnownTissue seen_in(const Visit& visit) {
  session::KnownTissue seen{.lay = visit.acupoints};
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone})
    if (visit.position == name_of(position)) seen.position = position;
  return seen;
}

}  // namespace

const Visit* last_said(std::span<const Visit> visits) {
  return newest(visits, [](const Visit& visit) { return !visit.said.empty(); });
}

const Visit* last_wish(std::span<const Visit> visits) {
  return newest(visits, [](const Visit& visit) { return std::isfinite(visit.intensity); });
}

const Visit* last_felt(std::span<const Visit> visits, std::optional<BodyPosture> position) {
  return newest(visits,
                [&](const Visit& visit) { return lay(visit, position) && !visit.tissue.empty(); });
}

std::optional<session::KnownTissue> last_lay(std::span<const Visit> visits,
                                             std::optional<BodyPosture> position) {
  const Visit* last = newest(
      visits, [&](const Visit& visit) { return lay(visit, position) && !visit.acupoints.empty(); });
  return last == nullptr ? std::nullopt : std::optional(seen_in(*last));
}

session::KnownTissue known_tissue(const Visit& felt, std::span<const Visit> visits) {
  constexpr double sd_of_95 = 1.96;
  const double scatter = log_scatter(visits);
  session::KnownTissue known = seen_in(felt);
  for (const VisitTissue& place : felt.tissue) {
    const double sd = place.stiffness_ci95_n_per_mm / sd_of_95 / place.stiffness_n_per_mm;
    if (!place.converged || !std::isfinite(sd) || !(place.alpha_n > 0.0 && place.beta_per_m > 0.0))
      continue;
    // Of a place pressed several times the last press counts.
    std::erase_if(known.places, [&](const auto& other) { return other.name == place.name; });
    known.places.push_back({.name = place.name,
                            .tissue = {place.alpha_n, place.beta_per_m},
                            .log_sd = std::sqrt(sd * sd + 2.0 * scatter * scatter)});
  }
  return known;
}

}  // namespace tuina::history
