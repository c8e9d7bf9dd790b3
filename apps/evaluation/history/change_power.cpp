// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/history/change_power.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/history/change.hpp"
#include "tuina/session/steering.hpp"
#include "tuina/sim/tissue_worlds.hpp"

namespace tuina::app {
namespace {

constexpr std::size_t places = 20;
constexpr int earlier_sessions = 3;
constexpr double harder_share = 0.1;

/// One person in one world, who comes again and again.
class FeltPerson {
 public:
  FeltPerson(const PowerWorld& world, std::uint64_t seed)
      : world_(world),
        tissue_world_(
            *std::ranges::find(sim::tissue_worlds(), world.tissue, &sim::TissueWorld::name)),
        seed_(seed),
        random_(make_random(seed, "power of the change test")) {
    for (TangentTissue& tissue : tissue_)
      tissue = {uniform(random_, 4.0, 12.0), uniform(random_, 200.0, 270.0)};
  }

  history::Visit session(double alpha_share) {
    history::Visit visit;
    const std::uint64_t drift = random_();
    for (std::size_t i = 0; i < places; ++i) {
      const double aside = gaussian(random_, world_.scatter);
      const TangentTissue today = {tissue_[i].alpha_n * (1.0 + alpha_share) * std::exp(aside),
                                   tissue_[i].beta_per_m * std::exp(0.4 * aside)};
      // The place stays what it is; the sensor errs alike in all places of a session.
      Random place = make_random(seed_ * places + i, "place"),
             sensor = make_random(drift, "sensor");
      visit.tissue.push_back(felt_at(i, today, {place, sensor, random_}));
    }
    return visit;
  }

 private:
  /// Five presses of a place.
  [[nodiscard]] history::VisitTissue felt_at(std::size_t place, const TangentTissue& today,
                                             const sim::WorldDraws& draws) const {
    const auto presses = sim::press_in_world(tissue_world_, sim::Pressing::swells, today, draws);
    session::SessionEstimator estimator;
    for (std::size_t i = 0; i < presses.last_press; ++i)
      estimator.update(presses.record[i].time_s, presses.record[i].press);
    const TissueEstimate& felt = estimator.estimate();
    return {.name = std::to_string(place),
            .alpha_n = felt.tissue.alpha_n,
            .alpha_ci95_n = felt.alpha_ci95_n};
  }

  const PowerWorld& world_;
  const sim::TissueWorld& tissue_world_;
  std::uint64_t seed_;
  Random random_;
  std::array<TangentTissue, places> tissue_;
};

}  // namespace

PowerOutcome try_power(const PowerWorld& world, std::uint64_t seed) {
  FeltPerson person(world, seed);
  std::vector<history::Visit> earlier;
  earlier.reserve(earlier_sessions);
  for (int i = 0; i < earlier_sessions; ++i) earlier.push_back(person.session(0.0));
  const history::Visit same = person.session(0.0), harder = person.session(harder_share);
  const auto changes_in = [&](const history::Visit& after) {
    return history::changes_between(earlier.back(), after, earlier);
  };
  const auto real_in = [](const history::Changes& changes) {
    return static_cast<int>(std::ranges::count_if(changes.places, &history::Change::real));
  };
  const history::Changes none = changes_in(same), all = changes_in(harder);
  PowerOutcome outcome{.places = places,
                       .found_of_all = real_in(all),
                       .found_whole = all.whole && all.whole->real,
                       .false_alarm = real_in(none) > 0 || (none.whole && none.whole->real),
                       .whole_change = all.whole ? all.whole->change : 0.0,
                       .scatter = none.scatter};
  for (std::size_t i = 0; i < places; ++i) {
    history::Visit one = same;
    one.tissue[i] = harder.tissue[i];
    for (const history::Change& place : changes_in(one).places)
      outcome.found += place.real && place.name == std::to_string(i) ? 1 : 0;
  }
  return outcome;
}

}  // namespace tuina::app
