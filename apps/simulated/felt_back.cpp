// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/felt_back.hpp"

#include <cmath>

#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

/// What lies under a zone before it is felt.
tissue::ClassProbabilities prior_of(massage::Zone zone) {
  switch (zone) {
    case massage::Zone::muscle:
      return {0.2, 0.5, 0.3};
    case massage::Zone::kidney:
      return {0.1, 0.35, 0.55};
    default:
      return {0.6, 0.25, 0.15};
  }
}

}  // namespace

FeltBack felt_back(const SessionResult& result, const tissue::BodyFacts& facts) {
  constexpr double max_nis = 4.0;  // beyond, the press does not follow the law
  FeltBack felt;
  std::vector<tissue::Visit> visits;
  std::vector<tissue::KnownPress> presses;
  for (std::size_t i = 0; i < result.session.performed.size(); ++i) {
    const session::Performed& done = result.session.performed[i];
    if (!done.felt) continue;
    const auto& planned = result.session.ready.plan.paths[static_cast<std::size_t>(done.path)];
    const FeltPoint point{
        .planned = &planned,
        .estimate = *done.felt,
        .truth = result.truth.touched[i].tissue,
        .classified = tissue::classify(*done.felt, done.nis, prior_of(planned.zone)),
        .place = {.at_in_couch = planned.path.points.front().at_in_couch,
                  .log_stiffness = std::log(
                      tissue::stiffness_at_force(done.felt->tissue, session::reference_force_n)),
                  .sd = done.stiffness_sd},
        .mapped = done.felt->presses >= 1 && done.nis <= max_nis};
    felt.points.push_back(point);
    if (!point.mapped) continue;
    visits.push_back({planned.path.acupoints.front(), point.place});
    presses.push_back({point.estimate.tissue, point.classified.label});
  }
  std::vector<tissue::FeltPlace> places;
  for (const tissue::Visit& visit : tissue::last_visits(visits)) places.push_back(visit.felt);
  felt.map = tissue::StiffnessMap(places);
  felt.twice = tissue::compare_visits(visits);
  std::erase_if(presses,
                [](const auto& press) { return press.at == tissue::TissueClass::unknown; });
  felt.condition = tissue::find_body_condition(presses, facts);
  felt.condition_presses = static_cast<int>(presses.size());
  return felt;
}

}  // namespace tuina::app
