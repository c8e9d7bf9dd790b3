// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/steering.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/depth_rules.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::session {
namespace {

constexpr double probe_press_s = 1.0;
constexpr double probe_period_s = 1.2;  // a press and a rest in which its end is noticed
constexpr int max_probes = 3;
constexpr std::size_t max_decisions = 4096;

double log_stiffness(const TangentTissue& tissue) noexcept {
  return std::log(tissue::stiffness_at_force(tissue, reference_force_n));
}

}  // namespace

Steering::Steering(const massage::Plan& plan, const Options& options)
    : options_(options), sides_{.of = {Side(options.presses), Side(options.presses)}} {
  std::map<std::string, int> known;
  for (const massage::PlannedPath& planned : plan.paths) {
    massage::PlannedPath without_points = planned;
    without_points.path.points.clear();
    paths_.push_back(std::move(without_points));
    strongest_n_.push_back(planned.ordered_n());
    int place = -1;
    if (planned.path.acupoints.size() == 1) {
      const int next = static_cast<int>(known.size());
      place = known.try_emplace(planned.path.acupoints.front(), next).first->second;
    }
    place_of_path_.push_back(place);
  }
  places_.resize(known.size());
  for (const KnownPlace& place : options_.known) {
    const auto found = known.find(place.name);
    if (found == known.end()) continue;
    Place& here = places_[static_cast<std::size_t>(found->second)];
    here.relies = true;
    here.known = place.tissue;
    here.known_sd = place.log_sd;
  }
  decisions_.reserve(max_decisions);
}

void Steering::decide(Arm arm, double time_s, Reason reason, double from_n, double to_n) noexcept {
  if (decisions_.size() == max_decisions) return;
  decisions_.push_back({.time_s = time_s,
                        .arm = arm,
                        .path = sides_[arm].path,
                        .rule = reason.rule,
                        .reason = reason.words,
                        .key = reason.key,
                        .from_n = from_n,
                        .to_n = to_n});
}

void Steering::begin(Arm arm, int path, double time_s) noexcept {
  Side& side = sides_[arm];
  const auto index = static_cast<std::size_t>(path);
  const massage::PlannedPath& planned = paths_[index];
  side.whole.next_place();
  side.elastic.reset();
  side.last.reset();
  side.path = path;
  side.presses = planned.path.technique == Technique::press;
  side.alarmed = side.worked_enough = false;
  side.probes = 0;
  side.foretold = tissue::Foretold::loosely;
  side.cap_n = planned.cap_n;
  side.reference_n = intensity_ * strongest_n_[index];
  side.probe_s = side.touched_s = time_s;
  side.peak_n = 0.0;
  begin_sets(side);
  const int number = place_of_path_[index];
  const Place place = number >= 0 ? places_[static_cast<std::size_t>(number)] : Place{};
  // Tissue is compared with what it was here, never with that of the place before.
  side.reference = place.reference;
  side.reference_nis = place.reference_nis;
  side.strongest_n = place.strongest_n;
  side.reference_is_earlier = place.felt;
  side.probing =
      options_.on && side.presses && !place.felt && side.reference_n > massage::kept_force_n;
  // Next to the spine every press of a new place is needed to tell bone (A8).
  const bool by_spine = planned.zone == massage::Zone::spine ||
                        planned.zone == massage::Zone::spine_margin ||
                        planned.zone == massage::Zone::gv4;
  side.relies = side.probing && place.relies && !by_spine;
  side.came_as_known = false;
  side.known = place.known;
  side.known_sd = place.known_sd;
  if (options_.on && place.felt) judge(arm, time_s);
}

void Steering::end(Arm arm) noexcept {
  Side& side = sides_[arm];
  const int number = side.path < 0 ? -1 : place_of_path_[static_cast<std::size_t>(side.path)];
  if (number < 0 || !side.presses || side.probing) return;
  side.whole.keep_person();
  Place& place = places_[static_cast<std::size_t>(number)];
  place.felt = true;
  place.strongest_n = side.strongest_n;
  if (tissue::may_steer(side.whole.estimate(), side.whole.nis())) {
    place.estimate = side.whole.estimate();
    place.nis = side.whole.nis();
  }
  if (tissue::may_steer(side.elastic.estimate(), side.elastic.nis())) {
    place.reference = side.elastic.estimate();
    place.reference_nis = side.elastic.nis();
  }
}

void Steering::feel(Arm arm, double time_s, const Press& press, double commanded_n) noexcept {
  Side& side = sides_[arm];
  side.whole.update(time_s, press);
  if (!options_.on || !side.presses) return;
  side.strongest_n = std::max(side.strongest_n, std::min(press.force_n, commanded_n));
  side.elastic.update(time_s, press);
  side.last.update(time_s, press);
  side.set.update(time_s, press);
  if (!side.probing) watch(arm, time_s);
}

void Steering::foretell(Side& side) noexcept {
  const bool narrow = side.whole.force_half_width(side.reference_n) <= tissue::well_foretold_share;
  side.foretold = side.whole.surprised() ? tissue::Foretold::wrongly
                  : narrow               ? tissue::Foretold::well
                                         : tissue::Foretold::loosely;
  side.deepening_m = side.whole.deepening_m(side.reference_n);
}

// A1 where an earlier session has felt the place. What this session feels is estimated without it,
// so that a change from session to session is not hidden by what was expected.
void Steering::compare_with_known(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  const KnownMatch matched = match(side.known, side.known_sd, side.whole.estimate().tissue,
                                   side.whole.covariance(), side.peak_n);
  side.came_as_known = matched == KnownMatch::holds;
  if (matched != KnownMatch::differs) return;
  side.relies = false;
  decide(arm, time_s,
         {"A1", "why_changed", "the tissue is not as it was felt earlier: probed as a new place"},
         side.peak_n, side.peak_n);
}

// A1: presses of a second, each as strong as the estimate after the last one allows.
double Steering::probe_force_n(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  const double region_n = paths_[static_cast<std::size_t>(side.path)].cap_n;
  const double since_s = time_s - side.probe_s;
  const int done = static_cast<int>(since_s / probe_period_s);
  if (side.peak_n == 0.0 || done > side.probes) {
    if (side.relies && done == 1) compare_with_known(arm, time_s);
    // Before its first press a place that is known is as if that one were over.
    const TissueEstimate estimate = side.relies && done == 0
                                        ? TissueEstimate{.tissue = side.known, .presses = 1}
                                        : side.whole.estimate();
    const bool enough = done >= max_probes || side.came_as_known ||
                        (done >= 2 && !side.whole.surprised() &&
                         tissue::probed_enough(estimate, side.peak_n, side.reference_n, region_n));
    if (enough) {
      constexpr Reason as_known{"A1", "why_known", "one press came as the place was felt earlier"};
      constexpr Reason probed{"A1", "why_probed", "probed the place before it is worked on"};
      decide(arm, time_s, side.came_as_known ? as_known : probed, 0.0, side.peak_n);
      side.probing = false;
      take_reference(side);
      side.last.reset();
      begin_sets(side);
      judge(arm, time_s);
      return massage::kept_force_n;
    }
    side.probes = done;
    side.peak_n = std::max({side.peak_n, massage::kept_force_n,
                            tissue::probing_force_n(estimate, side.reference_n, region_n)});
  }
  const double in_press_s = std::min(std::fmod(since_s, probe_period_s), probe_press_s);
  const double swell = 0.5 * (1.0 - std::cos(2.0 * pi * in_press_s / probe_press_s));
  return massage::kept_force_n + swell * (side.peak_n - massage::kept_force_n);
}

void Steering::take_reference(Side& side) noexcept {
  side.reference = side.elastic.estimate();
  side.reference_nis = side.elastic.nis();
  side.reference_is_earlier = false;
}

// Whatever the map says: what feels like bone so near to the spine is the spine.
bool Steering::bone_by_spine(const Side& side) const noexcept {
  const auto index = static_cast<std::size_t>(side.path);
  const massage::Zone zone = paths_[index].zone;
  if (zone != massage::Zone::spine_margin && zone != massage::Zone::gv4) return false;
  const auto is_bone = [](const TissueEstimate& estimate, double nis) {
    return tissue::may_steer(estimate, nis) &&
           tissue::classify(estimate, nis).label == tissue::TissueClass::bone;
  };
  if (side.presses && tissue::may_steer(side.whole.estimate(), side.whole.nis()))
    return is_bone(side.whole.estimate(), side.whole.nis());
  const int number = place_of_path_[index];
  if (number < 0) return false;
  const Place& place = places_[static_cast<std::size_t>(number)];
  return is_bone(place.estimate, place.nis);
}

void Steering::lower(Side& side, Arm arm, double time_s, double cap_n, Reason reason) noexcept {
  constexpr double tells_n = 0.5;  // less is no news
  const double planned_n = std::min(side.reference_n, side.cap_n);
  side.cap_n = std::min(side.cap_n, cap_n);
  if (side.cap_n < planned_n - tells_n) decide(arm, time_s, reason, planned_n, side.cap_n);
}

// Cap of the next press at this place: that of rule A2, and where the place feels like bone beside
// the spine (A8), what a spinous process bears.
void Steering::judge(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  const massage::PlannedPath& planned = paths_[static_cast<std::size_t>(side.path)];
  side.cap_n = planned.cap_n;
  foretell(side);
  if (bone_by_spine(side)) {
    lower(side, arm, time_s, massage::perhaps_spine_n(planned.path.technique),
          {"A8", "why_perhaps_spine", "bone where the spine may be: no more than a process bears"});
  }
  if (!side.presses || !options_.cautious) return;
  constexpr Reason otherwise{
      "A2", "why_otherwise",
      "the last press came otherwise than foretold: no firmer than the strongest so far"};
  constexpr Reason unsure{
      "A2", "why_unsure",
      "the tissue is not known well enough: at most twice the strongest press so far"};
  lower(side, arm, time_s, tissue::firmest_next_n(side.foretold, side.strongest_n, planned.cap_n),
        side.foretold == tissue::Foretold::wrongly ? otherwise : unsure);
}

// A9: each press against the first ones.
void Steering::watch(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  if (side.alarmed || side.last.estimate().presses == 0) return;
  const TissueEstimate now = side.last.estimate();
  side.last.reset();
  count_press(arm, time_s);
  judge(arm, time_s);
  if (!tissue::may_steer(side.reference, side.reference_nis)) {
    // What the probing presses could not tell, a full one has.
    if (tissue::may_steer(side.elastic.estimate(), side.elastic.nis())) take_reference(side);
    return;
  }
  if (std::exchange(side.reference_is_earlier, false)) side.reference.contact_m = now.contact_m;
  const tissue::Alarm alarm = tissue::compare(side.reference, now, reference_force_n);
  if (alarm == tissue::Alarm::none) return;
  side.alarmed = true;
  decide(arm, time_s, {"A9", tissue::key_of(alarm), tissue::name_of(alarm)},
         std::min(side.reference_n, side.cap_n), 0.0);
}

void Steering::begin_sets(Side& side) noexcept {
  side.set.reset();
  side.sets_felt = 0;
  side.set_presses = 0;
}

// A7: each set of presses against the first one, and against the one before. Six presses alone
// seldom converge, but how well they are known is part of what is compared.
void Steering::count_press(Arm arm, double time_s) noexcept {
  constexpr int presses_of_a_set = 6;
  Side& side = sides_[arm];
  if (++side.set_presses < presses_of_a_set || side.sets_felt == max_sets) return;
  const bool known = tissue::may_steer(side.reference, side.reference_nis);
  if (!known || !tissue::follows_law(side.set.estimate(), side.set.nis())) return;
  side.sets[side.sets_felt++] = {.log_stiffness = log_stiffness(side.set.estimate().tissue),
                                 .sd = side.set.stiffness_sd(reference_force_n)};
  side.set.reset();
  side.set_presses = 0;
  const tissue::Dwell dwell = tissue::dwell_after(
      std::span<const tissue::PressSet>(side.sets.data(), side.sets_felt), time_s - side.touched_s);
  if (dwell == tissue::Dwell::go_on || side.worked_enough) return;
  side.worked_enough = true;
  decide(arm, time_s, {"A7", tissue::key_of(dwell), tissue::name_of(dwell)},
         std::min(side.reference_n, side.cap_n), 0.0);
}

double Steering::steered_n(Arm arm, double planned_n) const noexcept {
  return std::min(planned_n, sides_[arm].cap_n);
}

}  // namespace tuina::session
