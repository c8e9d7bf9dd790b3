// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/history/change_power.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tuina/core/random.hpp"
#include "tuina/history/change.hpp"
#include "tuina/session/steering.hpp"
#include "tuina/sim/tissue_worlds.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

constexpr std::size_t places = 20;
constexpr int earlier_sessions = 3;
constexpr double harder_share = 0.1;

const sim::TissueWorld& living_world() {
  return *std::ranges::find(sim::tissue_worlds(), "everything", &sim::TissueWorld::name);
}

/// Five presses of a place.
history::VisitTissue felt_at(std::size_t place, const TangentTissue& tissue, Random& random) {
  const auto presses = sim::press_in_world(living_world(), sim::Pressing::swells, tissue, random);
  session::SessionEstimator estimator;
  for (std::size_t i = 0; i < presses.last_press; ++i)
    estimator.update(presses.record[i].time_s, presses.record[i].press);
  const double stiffness_n_per_mm =
      1e-3 * tissue::stiffness_at_force(estimator.estimate().tissue, session::reference_force_n);
  const double sd = estimator.stiffness_sd(session::reference_force_n);
  return {.name = std::to_string(place),
          .stiffness_n_per_mm = stiffness_n_per_mm,
          .stiffness_ci95_n_per_mm = 1.96 * sd * stiffness_n_per_mm};
}

}  // namespace

PowerOutcome try_power(double scatter, std::uint64_t seed) {
  Random random = make_random(seed, "power of the change test");
  std::array<TangentTissue, places> person;
  for (TangentTissue& tissue : person)
    tissue = {uniform(random, 4.0, 12.0), uniform(random, 200.0, 270.0)};
  const auto session = [&](double alpha_share) {
    history::Visit visit;
    for (std::size_t i = 0; i < places; ++i) {
      const double aside = gaussian(random, scatter);
      const TangentTissue today = {person[i].alpha_n * (1.0 + alpha_share) * std::exp(aside),
                                   person[i].beta_per_m * std::exp(0.4 * aside)};
      visit.tissue.push_back(felt_at(i, today, random));
    }
    return visit;
  };
  std::vector<history::Visit> earlier;
  for (int i = 0; i < earlier_sessions; ++i) earlier.push_back(session(0.0));
  const history::Visit same = session(0.0), harder = session(harder_share);
  const auto real_in = [&](const history::Visit& after) {
    std::vector<std::string> real;
    for (const auto& place : history::changes_between(earlier.back(), after, earlier).places)
      if (place.real) real.push_back(place.name);
    return real;
  };
  PowerOutcome outcome{.places = places,
                       .found_of_all = static_cast<int>(real_in(harder).size()),
                       .false_alarm = !real_in(same).empty(),
                       .scatter = history::changes_between(earlier.back(), same, earlier).scatter};
  for (std::size_t i = 0; i < places; ++i) {
    history::Visit one = same;
    one.tissue[i] = harder.tissue[i];
    const auto real = real_in(one);
    outcome.found += std::ranges::count(real, std::to_string(i)) > 0 ? 1 : 0;
    const TangentTissue& was = person[i];
    const TangentTissue is = {was.alpha_n * (1.0 + harder_share), was.beta_per_m};
    outcome.stiffness_change += (tissue::stiffness_at_force(is, session::reference_force_n) /
                                     tissue::stiffness_at_force(was, session::reference_force_n) -
                                 1.0) /
                                static_cast<double>(places);
  }
  return outcome;
}

}  // namespace tuina::app
