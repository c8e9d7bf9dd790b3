// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/felt_back.hpp"

#include <cmath>

#include "tuina/tissue/body_condition.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/estimator.hpp"
#include "tuina/tissue/stiffness_map.hpp"
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

void add_felt_back(const SessionResult& result, record::SessionFile& file) {
  // Stiffness as people read it, from the logarithm of N/m.
  const auto n_per_mm = [](double log_stiffness) { return 1e-3 * std::exp(log_stiffness); };
  std::vector<tissue::Visit> visits;
  std::vector<tissue::KnownPress> presses;
  for (std::size_t i = 0; i < result.session.performed.size(); ++i) {
    const session::Performed& done = result.session.performed[i];
    if (!done.felt) continue;
    const auto& planned = result.session.ready.plan.paths[static_cast<std::size_t>(done.path)];
    const std::string& name = planned.path.acupoints.front();
    const auto classified = tissue::classify(*done.felt, done.nis, prior_of(planned.zone));
    const tissue::FeltPlace place{.at_in_couch = planned.path.points.front().at_in_couch,
                                  .log_stiffness = std::log(tissue::stiffness_at_force(
                                      done.felt->tissue, session::reference_force_n)),
                                  .sd = done.stiffness_sd};
    const bool mapped = done.felt->presses >= 1 && done.nis <= tissue::max_nis &&
                        done.contact_fault == control::ContactFault::none;
    const double stiffness_n_per_mm = n_per_mm(place.log_stiffness);
    file.tissue.push_back(
        {.name = name,
         .at_in_couch = place.at_in_couch,
         .estimate = *done.felt,
         .truth = result.simulated ? std::optional(result.truth.touched[i].tissue) : std::nullopt,
         .tissue_class = tissue::name_of(classified.label),
         .class_probability = classified.probability,
         .stiffness_n_per_mm = stiffness_n_per_mm,
         .stiffness_ci95_n_per_mm = 1.96 * place.sd * stiffness_n_per_mm,
         .mapped = mapped});
    if (!done.felt->converged)
      file.tissue.back().estimate.converged_after_s = std::numeric_limits<double>::quiet_NaN();
    if (!mapped) continue;
    visits.push_back({name, place});
    if (classified.label != tissue::TissueClass::unknown)
      presses.push_back({done.felt->tissue, classified.label});
  }
  file.stiffness_force_n = session::reference_force_n;
  for (const tissue::ComparedVisits& twice : tissue::compare_visits(visits)) {
    file.changes.push_back({.name = twice.name,
                            .before_n_per_mm = n_per_mm(twice.before.log_stiffness),
                            .after_n_per_mm = n_per_mm(twice.after.log_stiffness),
                            .detectable = std::expm1(twice.change.detectable),
                            .detected = twice.change.told,
                            .change = std::expm1(twice.change.log_change)});
  }
  const auto condition = tissue::find_body_condition(presses, file.order.facts);
  file.condition = {condition.slim, condition.medium, condition.hefty, condition.female};
  file.condition_presses = static_cast<int>(presses.size());
}

}  // namespace tuina::app
