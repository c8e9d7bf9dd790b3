// SPDX-License-Identifier: Apache-2.0
// What the massage does on the skin, from the approach to letting go.
#include <algorithm>
#include <cmath>

#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/session/massage_step.hpp"

namespace tuina::session {
namespace {

/// What is expected of a place before it was felt: Table 6-2 of [thesis], medium build, by what
/// lies there.
TangentTissue expected_in(massage::Zone zone) noexcept {
  switch (zone) {
    case massage::Zone::scapula_edge:
    case massage::Zone::ribs:
    case massage::Zone::iliac_crest:
    case massage::Zone::gv4:
    case massage::Zone::spine:
    case massage::Zone::spine_margin:
      return {.alpha_n = 4.5, .beta_per_m = 265.0};
    case massage::Zone::kidney:
      return {.alpha_n = 4.5, .beta_per_m = 210.0};
    default:
      return control::ContactModel{}.tissue;
  }
}

/// What a press aims at: the true force swings about its target by some tenths of a newton, and
/// nobody shall get more than was ordered. Light presses give up no more than 4 %.
double aimed_n(double ordered_n) noexcept {
  constexpr double swings_n = 0.3, swings_share = 0.015, max_share = 0.04;
  return ordered_n - std::max(swings_share * ordered_n, std::min(swings_n, max_share * ordered_n));
}

}  // namespace

void MassageStep::begin_approach(Side& side, Arm arm, double time_s) noexcept {
  const massage::PlannedPath& planned = *path_of(side);
  side.again = side.cut_short = false;
  side.wanted = base_path_of(side).points.front();
  side.wanted.at_in_base += shift_in_base_;
  side.commanded_n = 0.0;  // after an escape it still is that of the place before
  side.controller().approach(
      {.at_in_base = side.wanted.at_in_base, .normal_in_base = side.wanted.normal_in_base});
  side.phase = ArmPhase::approach;
  steering_.begin(arm, job_of(side)->path, time_s);
  side.foreknown = options_.steer && steering_.known(arm) != nullptr;
  side.expected = side.foreknown ? *steering_.known(arm) : expected_in(planned.zone);
}

void MassageStep::begin_contact(Side& side, Arm arm, double time_s) noexcept {
  side.contact_s = time_s;
  side.registered = false;
  side.probed_s = 0.0;
  side.phase = ArmPhase::contact;
  steering_.touch(arm, time_s);
  // After probing the tool already is on the skin, with the light touch that a path begins with.
  side.playback.begin(steering_.probing(arm) ? massage::landing_s : 0.0);
  side.beats.begin(path_of(side)->ordered_n());
}

/// One millisecond of a contact.
void MassageStep::press_on(Side& side, Arm arm, double time_s) noexcept {
  const massage::PlannedPath& planned = *path_of(side);
  const control::ArmStatus& status = side.controller().status();
  if (steering_.probing(arm) && !side.playback.fading()) {
    side.playback.begin(massage::landing_s);
    side.probed_s += std::max(side.playback.rate(), 0.0) * control_period_s;
  }
  const bool leaves = side.skip || steering_.alarmed(arm);
  // What a place bears it bears with its probing presses, and no tool leaves in no time.
  constexpr double fades_s = 0.5;
  const double max_s = massage::rule_of(planned.zone).max_duration_s - fades_s;
  const bool over = side.probed_s > 0.0 && side.probed_s + side.playback.path_s() > max_s;
  if ((leaves || over || steering_.worked_enough(arm)) && !side.playback.fading()) {
    side.playback.fade();
    side.cut_short = leaves;
  }
  if (status.contact_fault != control::ContactFault::none || side.playback.faded() ||
      side.playback.path_s() >= planned.path.duration_s()) {
    side.contact_fault = status.contact_fault;
    side.cut_short = side.cut_short || status.contact_fault != control::ContactFault::none;
    end_contact(side, arm, time_s);
    if (side.contact_fault != control::ContactFault::none) startled_s_ = time_s;
    return;
  }
  register_skin(side, time_s);
  if (side.phase != ArmPhase::contact) return;
  const BasePlace now = place_at(base_path_of(side), side.playback.path_s());
  side.wanted = now.point;
  side.wanted.at_in_base += shift_in_base_;
  if (!side.frozen) steering_.stand_still(arm, (1.0 - side.playback.rate()) * control_period_s);
  const double planned_n = steering_.probing(arm) ? steering_.probe_force_n(arm, time_s)
                                                  : steering_.steered_n(arm, now.point.force_n);
  const double max_n = std::min({options_.force_ceiling_n, planned.cap_n, steering_.max_n(arm)});
  side.wanted.force_n = std::min(side.playback.force_n(planned_n), max_n);
  if (planned.path.technique == Technique::press)
    side.wanted.force_n = aimed_n(side.wanted.force_n);
  side.commanded_n = side.wanted.force_n;
  if (planned.path.technique == Technique::tap)
    side.commanded_n = std::min(side.beats.command_n(side.wanted.force_n, status.force_n), max_n);
  side.controller().track(
      {.at_in_base = side.wanted.at_in_base,
       .velocity_m_per_s = side.playback.rate() * now.velocity_in_base_m_per_s,
       .normal_in_base = now.point.normal_in_base,
       .force_n = side.commanded_n,
       .max_spring_n = max_spring_n(guarded_zone(planned.zone)),
       .model = {.tissue = side.expected,
                 .torso_n_per_m = 1.0 / (1.0 / options_.torso_n_per_m + gears_m_per_n(arm))}});
}

double MassageStep::gears_m_per_n(Arm arm) const noexcept {
  const Side& side = sides_[arm];
  return robot::unseen_yield_m_per_n(models_[arm].table(), side.controller().dynamics().jacobian,
                                     side.wanted.normal_in_base);
}

/// Where the tool found the skin tells how the person has shifted since the scan, along the normal
/// that was touched. Breath moves it by a few millimetres to either side, so each contact counts
/// for a part only, once.
void MassageStep::register_skin(Side& side, double time_s) noexcept {
  constexpr double after_s = 0.4, share = 0.3;
  if (side.registered || time_s - side.contact_s < after_s) return;
  side.registered = true;
  const double deeper_m = side.controller().status().skin_error_m;
  if (std::abs(deeper_m) > options_.max_shift_m) return leave(time_s);
  next_shift_in_base_ -= share * deeper_m * side.wanted.normal_in_base;
}

void MassageStep::end_contact(Side& side, Arm arm, double time_s) noexcept {
  const massage::PlannedPath& planned = *path_of(side);
  Performed done{.path = job_of(side)->path,
                 .arm = arm,
                 .begin_s = side.contact_s,
                 .end_s = time_s,
                 .contact_fault = side.contact_fault,
                 .whole = !side.cut_short && side.contact_fault == control::ContactFault::none,
                 .skipped = side.skip,
                 .felt = {}};
  const bool feels = planned.path.technique == Technique::press;
  if (feels && time_s > side.contact_s) {
    done.felt = steering_.estimate(arm);
    done.nis = steering_.nis(arm);
    done.stiffness_sd = steering_.stiffness_sd(arm);
  }
  steering_.end(arm);
  if (performed_.size() < performed_.capacity()) performed_.push_back(done);
  side.skip = false;
  side.controller().retract(options_.standoff_m);
  side.phase = ArmPhase::retract;
}

void MassageStep::feel(Side& side, Arm arm, double time_s, const ArmState& state) noexcept {
  // The approach counts too: in the air the estimator learns the zero of the force sensor.
  if (side.phase != ArmPhase::approach && side.phase != ArmPhase::contact) return;
  const Vector3& normal = side.wanted.normal_in_base;
  const Vector3 tip = state.base_from_tool.translation() - tool_radius_m_ * normal;
  const double force_n = normal.dot(state.contact_in_base.force_n);
  const double depth_m = normal.dot(side.wanted.at_in_base - tip);
  steering_.feel(arm, time_s,
                 {.depth_m = depth_m - force_n * gears_m_per_n(arm), .force_n = force_n},
                 side.commanded_n);
  const TissueEstimate& estimate = steering_.estimate(arm);
  // A new law of the tissue moves the virtual target and with it the tool, so it is taken over
  // between two presses only.
  constexpr double barely_n = 0.5;
  const bool pressing = side.commanded_n > massage::kept_force_n + barely_n;
  if (options_.steer && tissue::may_steer(estimate, steering_.nis(arm))) {
    if (!pressing) side.expected = estimate.tissue;
  } else if (side.foreknown && steering_.known(arm) == nullptr) {
    side.expected = expected_in(path_of(side)->zone);
    side.foreknown = false;
  }
}

}  // namespace tuina::session
