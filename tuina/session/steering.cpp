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
  const double F = reference_force_n, alpha = tissue.alpha_n;
  return std::log(tissue.beta_per_m * (alpha * alpha + F * F) / alpha);
}

}  // namespace

Steering::Steering(const massage::Plan& plan, const tissue::PressEstimatorOptions& presses, bool on)
    : on_(on), sides_{.of = {Side(presses), Side(presses)}} {
  std::map<std::string, int> known;
  for (const massage::PlannedPath& planned : plan.paths) {
    massage::PlannedPath without_points = planned;
    without_points.path.points.clear();
    paths_.push_back(std::move(without_points));
    double strongest_n = 0.0;
    for (const ContactPoint& point : planned.path.points) {
      strongest_n = std::max(strongest_n, point.force_n);
    }
    strongest_n_.push_back(strongest_n);
    int place = -1;
    if (planned.path.acupoints.size() == 1) {
      const int next = static_cast<int>(known.size());
      place = known.try_emplace(planned.path.acupoints.front(), next).first->second;
    }
    place_of_path_.push_back(place);
  }
  places_.resize(known.size());
  betas_.reserve(known.size() + 1);
  decisions_.reserve(max_decisions);
}

void Steering::decide(Arm arm, double time_s, const char* rule, const char* reason, double from_n,
                      double to_n) noexcept {
  if (decisions_.size() == max_decisions) return;
  decisions_.push_back({.time_s = time_s,
                        .arm = arm,
                        .path = sides_[arm].path,
                        .rule = rule,
                        .reason = reason,
                        .from_n = from_n,
                        .to_n = to_n});
}

void Steering::begin(Arm arm, int path, double time_s) noexcept {
  Side& side = sides_[arm];
  const auto index = static_cast<std::size_t>(path);
  const massage::PlannedPath& planned = paths_[index];
  side.whole.reset();
  side.last.reset();
  side.path = path;
  side.presses = planned.path.technique == Technique::press;
  side.alarmed = side.known = side.worked_enough = false;
  side.compared = 0;
  side.cap_n = planned.cap_n;
  side.scale = 1.0;
  side.reference_n = strongest_n_[index];
  side.probe_s = side.touched_s = time_s;
  side.peak_n = 0.0;
  begin_sets(side);
  const int place = place_of_path_[index];
  const bool felt = place >= 0 && places_[static_cast<std::size_t>(place)].felt;
  // Tissue is compared with what it was here, never with that of the place before.
  side.reference = felt ? places_[static_cast<std::size_t>(place)].estimate : TissueEstimate{};
  side.elsewhen = felt;
  side.probing = on_ && side.presses && !felt && side.reference_n > massage::kept_force_n;
  if (on_ && felt) judge(arm, time_s);
}

void Steering::end(Arm arm) noexcept {
  Side& side = sides_[arm];
  const int number = side.path < 0 ? -1 : place_of_path_[static_cast<std::size_t>(side.path)];
  if (number < 0 || !side.presses) return;
  if (!tissue::may_steer(side.whole.estimate(), side.whole.nis())) return;
  places_[static_cast<std::size_t>(number)] = {
      .felt = true, .estimate = side.whole.estimate(), .nis = side.whole.nis()};
}

void Steering::feel(Arm arm, double time_s, const Press& press) noexcept {
  Side& side = sides_[arm];
  side.whole.update(time_s, press);
  if (!on_ || !side.presses) return;
  side.last.update(time_s, press);
  side.set.update(time_s, press);
  if (!side.probing) watch(arm, time_s);
}

// A1: presses of a second, each as strong as the estimate after the last one allows.
double Steering::probe_force_n(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  const double region_n = std::min(side.cap_n, paths_[static_cast<std::size_t>(side.path)].cap_n);
  const double since_s = time_s - side.probe_s;
  const TissueEstimate& estimate = side.whole.estimate();
  const int done = static_cast<int>(since_s / probe_period_s);
  if (side.peak_n == 0.0 || done > side.compared) {
    const bool enough =
        done >= 2 && (tissue::probed_enough(estimate, side.peak_n, region_n) || done >= max_probes);
    if (enough) {
      decide(arm, time_s, "A1", "probed the place before it is worked on", 0.0, side.peak_n);
      side.probing = false;
      side.compared = estimate.presses;
      side.reference = estimate;
      side.elsewhen = false;
      side.last.reset();
      begin_sets(side);
      judge(arm, time_s);
      return massage::kept_force_n;
    }
    side.compared = done;
    side.peak_n = std::max({side.peak_n, massage::kept_force_n,
                            std::min(tissue::probing_force_n(estimate, region_n), region_n)});
  }
  const double in_press_s = std::min(std::fmod(since_s, probe_period_s), probe_press_s);
  const double swell = 0.5 * (1.0 - std::cos(2.0 * pi * in_press_s / probe_press_s));
  return massage::kept_force_n + swell * (side.peak_n - massage::kept_force_n);
}

// A2, A3 and A8: what the place bears.
void Steering::judge(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  const auto index = static_cast<std::size_t>(side.path);
  const massage::PlannedPath& planned = paths_[index];
  const int number = place_of_path_[index];
  Place fresh{.felt = false, .estimate = side.whole.estimate(), .nis = side.whole.nis()};
  Place& place = number >= 0 ? places_[static_cast<std::size_t>(number)] : fresh;
  const bool unknown = !place.felt || !tissue::may_steer(place.estimate, place.nis);
  if (unknown && side.presses) place = {.felt = true, .estimate = fresh.estimate, .nis = fresh.nis};
  const double before_n = std::min(side.reference_n, planned.cap_n);

  side.known = tissue::may_steer(place.estimate, place.nis);
  if (!side.known) {
    // Only pressing goes deep enough for the half of an unknown place to matter.
    if (!side.presses) return;
    side.cap_n = tissue::force_cap_n(place.estimate, place.nis, planned.cap_n);
    decide(arm, time_s, "A2", "the tissue is not known well enough: at most half of the zone's cap",
           before_n, std::min(before_n, side.cap_n));
    return;
  }
  if (side.presses && !side.probing && side.compared > 0) {
    sum_log_stiffness_ += log_stiffness(place.estimate.tissue);
    if (betas_.size() < betas_.capacity()) {
      betas_.insert(
          std::upper_bound(betas_.begin(), betas_.end(), place.estimate.tissue.beta_per_m),
          place.estimate.tissue.beta_per_m);
    }
  }
  // Whatever the map says: what feels like bone so near to the spine is the spine.
  const bool near_spine =
      planned.zone == massage::Zone::spine_margin || planned.zone == massage::Zone::gv4;
  const double bears_n = massage::perhaps_spine_n(planned.path.technique);
  if (near_spine && before_n > bears_n &&
      tissue::classify(place.estimate, place.nis).label == tissue::TissueClass::bone) {
    side.cap_n = bears_n;
    decide(arm, time_s, "A8", "bone where the spine may be: no more than a process bears", before_n,
           side.cap_n);
    return;
  }
  side.cap_n = tissue::force_cap_n(place.estimate, place.nis, planned.cap_n);
  if (side.cap_n < before_n) {
    decide(arm, time_s, "A3",
           "three times the hardness is enough: beyond, the tissue is compressed", before_n,
           side.cap_n);
  }
  constexpr std::size_t enough_places = 3;
  if (betas_.size() < enough_places) return;
  const tissue::PersonMean person{
      .log_stiffness = sum_log_stiffness_ / static_cast<double>(betas_.size()),
      .median_beta_per_m = betas_[betas_.size() / 2]};
  const tissue::TechniqueAdvice advice =
      tissue::technique_for(place.estimate, place.nis, person, side.reference_n, planned.cap_n);
  if (!advice.known) return;
  const double now_n = std::min(before_n, side.cap_n);
  if (advice.technique == Technique::stroke && advice.force_n < now_n) {
    side.cap_n = advice.force_n;
    decide(arm, time_s, "A8", "a thin layer over bone: lightly", now_n, side.cap_n);
  } else if (advice.technique == Technique::press && side.presses && advice.force_n > now_n) {
    side.scale = std::min(advice.force_n, side.cap_n) / std::max(side.reference_n, 1.0);
    decide(arm, time_s, "A8", "much harder than this person's mean: a fifth more", now_n,
           side.scale * side.reference_n);
  }
}

// A9: each press against the first ones.
void Steering::watch(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  if (side.alarmed || side.last.estimate().presses == 0) return;
  const TissueEstimate now = side.last.estimate();
  side.last.reset();
  count_press(arm, time_s);
  if (!side.known && tissue::may_steer(side.whole.estimate(), side.whole.nis())) {
    // What the probing presses could not tell, a full one has.
    side.reference = side.whole.estimate();
    side.elsewhen = false;
    return judge(arm, time_s);
  }
  if (!tissue::may_steer(side.reference, side.whole.nis())) return;
  if (std::exchange(side.elsewhen, false)) side.reference.contact_m = now.contact_m;
  const tissue::Alarm alarm = tissue::compare(side.reference, now, reference_force_n);
  if (alarm == tissue::Alarm::none) return;
  side.alarmed = true;
  decide(arm, time_s, "A9", tissue::name_of(alarm), std::min(side.reference_n, side.cap_n), 0.0);
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
  if (!side.known || !tissue::follows_law(side.set.estimate(), side.set.nis())) return;
  side.sets[side.sets_felt++] = {.log_stiffness = log_stiffness(side.set.estimate().tissue),
                                 .sd = side.set.stiffness_sd(reference_force_n)};
  side.set.reset();
  side.set_presses = 0;
  const tissue::Dwell dwell = tissue::dwell_after(
      std::span<const tissue::PressSet>(side.sets.data(), side.sets_felt), time_s - side.touched_s);
  if (dwell == tissue::Dwell::go_on || side.worked_enough) return;
  side.worked_enough = true;
  decide(arm, time_s, "A7", tissue::name_of(dwell), std::min(side.reference_n, side.cap_n), 0.0);
}

double Steering::steered_n(Arm arm, double planned_n) const noexcept {
  const Side& side = sides_[arm];
  return std::min(planned_n * side.scale, side.cap_n);
}

}  // namespace tuina::session
