// SPDX-License-Identifier: Apache-2.0
// The law with which a guard drives an arm that it has taken over, and whether the arm obeys it.
#include <algorithm>
#include <cmath>

#include "tuina/safety/guard.hpp"

namespace tuina::safety {
namespace {

// The law is soft enough to be safe on any tissue, damped enough to stop a moving arm.
constexpr double own_stiffness_n_per_m = 800.0;
constexpr double own_damping_n_s_per_m = 60.0;
constexpr double own_posture_nm_per_rad = 4.0;
// A joint that comes to its end stands still at once, and the person who pushes the tool runs into
// the rest of the arm: springs begin before, so that the other joints turn in time.
constexpr double before_end_rad = 0.15, off_end_nm_per_rad = 30.0;
constexpr double own_joint_damping_nm_s_per_rad = 0.8;
// Damping of the joints alone, where the place of the tool is not known.
constexpr double blind_joint_damping_nm_s_per_rad = 8.0;
constexpr double retract_m_per_s = 0.1;
constexpr double retract_m = 0.06;
constexpr double max_inward_n = 5.0;
constexpr double max_outward_n = 40.0;
constexpr double pressed_n = 5.0;  // from here the person is still in the way of leaving
constexpr double push_out_n = 80.0;
// A tool that flies feels its own mass as it is braked, and swings on elastic gears: taken for a
// person, each swing would push it on. A person who comes after it is felt for longer than a swing;
// without such a contact it is not followed beyond the way that it leaves by.
constexpr int meeting_ticks = 40;
// A person sits up at half a metre a second (docs/safety.md); the tool must be able to be faster.
constexpr double push_out_m_per_s = 0.8;
// As far and as fast as who sits up comes.
constexpr double blind_way_m = 0.2, blind_m_per_s = 0.5;

// An arm whose joints are not known, or in doubt, leaves the skin by what was known last: the
// levers turn by less than a tenth meanwhile. Joints stick, so soft skin alone does not push a tool
// off.
constexpr double blind_push_n = 40.0;
constexpr int blind_push_ticks = 60;

constexpr int disobedient_ticks = 50;
constexpr double disobedient_m_per_s = 0.05;  // into the body, against 80 N outward
// Force from which a leaving tool that still moves inward counts as digging: this much, and so much
// above the least that was felt since it leaves. It is braked then; with less force that would be
// worse, since a body that breathes against a braked arm is pressed harder.
constexpr double digging_n = 40.0, digging_rise_n = 15.0;
constexpr double plunging_m_per_s = 0.3;  // into the body, faster than any order or hand
constexpr int digging_ticks = 3;
constexpr double runaway_m_per_s = 1.2;  // beyond what a person and the push together reach aside
constexpr double thrown_m_per_s = 1.2;   // likewise outward, where they may come after the tool
constexpr int runaway_ticks = 10;

}  // namespace

// A sensor that is silent, stuck or reversed feels nothing.
bool Guard::feels() const noexcept {
  return !force_doubted_ && sample_age_s_ <= options_.limits.stale_freeze_s;
}

// Pressed is a tool on which a living sensor feels a force out of the body, whatever else it feels.
bool Guard::pressed() const noexcept {
  return feels() && medians_n_.back() > pressed_n &&
         sample_in_base_n_.dot(normal_in_base_) > pressed_n;
}

// Only a living sensor can tell that nobody is there.
bool Guard::in_air() const noexcept {
  return feels() && medians_n_.back() < pressed_n;
}

// An arm that goes into the body although it is pushed out, or that races, has drives or encoders
// that no law of its own can mend. One that presses harder and harder meanwhile is not a person who
// comes closer, for that one pushes the tool outward.
void Guard::judge_obedience(const Observation& seen, Finding& finding) noexcept {
  const double outward_m_per_s = seen.tool_velocity_m_per_s.dot(normal_in_base_);
  const double inward_m_per_s = -outward_m_per_s;
  const double borne_m_per_s = std::min(outward_m_per_s, thrown_m_per_s);  // inward it plunges
  const Vector3 judged_m_per_s = seen.tool_velocity_m_per_s - borne_m_per_s * normal_in_base_;
  const bool driven = state_ >= GuardState::complying;
  const bool races = driven && judged_m_per_s.norm() > runaway_m_per_s;
  const bool against =
      state_ == GuardState::retracting && pressed() && inward_m_per_s > disobedient_m_per_s;
  const bool digs = against && felt_n() > std::max(min_felt_n_ + digging_rise_n, digging_n);
  const bool plunges = driven && inward_m_per_s > plunging_m_per_s;
  if (digs || plunges)
    not_obeyed_ += disobedient_ticks / digging_ticks + 1;
  else if (races)
    not_obeyed_ += disobedient_ticks / runaway_ticks;
  else
    not_obeyed_ = against ? not_obeyed_ + 1 : 0;
  if (not_obeyed_ >= disobedient_ticks) finding.add(Action::brake, Cause::not_obeyed);
}

// Brakes let an arm sink by some millimetres before they hold, and hold it there: a tool that
// pressed has to leave the skin first.
void Guard::judge_unknown(Finding& finding) noexcept {
  const bool pressed_before = medians_n_.back() > pressed_n;
  const bool leaves = pressed_before && unknown_++ < blind_push_ticks;
  finding.add(leaves ? Action::retract : Action::brake, Cause::state_not_finite);
}

bool Guard::leaves_in_doubt() const noexcept {
  return pressed() || (pressed_at_doubt_ && blind_ <= blind_push_ticks);
}

JointVector Guard::blind_torque(Action action) const noexcept {
  return gravity_nm_ + (action == Action::brake ? 0.0 : blind_push_n) * levers_m_;
}

// Where the joints are in doubt the tool's place is too: they are damped, and no law of the tool
// drives them but a push off the skin.
JointVector Guard::torque_in_doubt(const JointVector& dq_rad_per_s) const noexcept {
  return blind_torque(leaves_in_doubt() ? Action::retract : Action::brake) -
         blind_joint_damping_nm_s_per_rad * dq_rad_per_s;
}

// An arm that stands there already when it is taken over is not moved away.
JointVector Guard::off_ends_nm(const JointVector& q_rad) const noexcept {
  JointVector torque_nm = JointVector::Zero(q_rad.size());
  for (Eigen::Index i = 0; i < options_.min_rad.size(); ++i) {
    const double low_rad = std::min(options_.min_rad[i] + before_end_rad, from_rad_[i]);
    const double high_rad = std::max(options_.max_rad[i] - before_end_rad, from_rad_[i]);
    const double beyond_rad = q_rad[i] - std::clamp(q_rad[i], low_rad, high_rad);
    torque_nm[i] = -off_end_nm_per_rad * beyond_rad;
  }
  return torque_nm;
}

bool Guard::followed(const Vector3& tool_in_base) noexcept {
  pressed_ticks_ = pressed() ? pressed_ticks_ + 1 : 0;
  if (pressed_ticks_ > meeting_ticks) met_in_base_ = tool_in_base;
  return pressed() && (tool_in_base - met_in_base_).dot(normal_in_base_) < retract_m;
}

JointVector Guard::own_torque(const Observation& seen, Action action) noexcept {
  if (action == Action::brake) return gravity_nm_;
  if (encoders_doubted_) return torque_in_doubt(seen.dq_rad_per_s);
  if (taken_over_ == Action::pass) from_rad_ = seen.q_rad;
  if (taken_over_ != action) {
    taken_over_ = action;
    hold_in_base_ = taken_over_in_base_ = last_pressed_in_base_ = seen.tool_in_base;
    met_in_base_ = seen.tool_in_base;
    hold_rad_ = seen.q_rad;
    // The median, for a single sample may be a blow that nobody has judged yet.
    held_n_ = pressed() ? std::min(felt_n(), sample_in_base_n_.dot(normal_in_base_)) : 0.0;
  }
  const double outward_m_per_s = seen.tool_velocity_m_per_s.dot(normal_in_base_);
  // Friction and a person who follows may hold the tool back, so the way is the tool's own.
  const double way_m = (seen.tool_in_base - taken_over_in_base_).dot(normal_in_base_);
  // A tool that pressed when its sensor failed does not wait to be felt.
  const bool flees = !feels() && believed_n_ > pressed_n && way_m < blind_way_m;
  const bool follows = followed(seen.tool_in_base);
  // A person who comes after the tool is met by nothing that holds it in place, nor aside, nor in
  // its posture, however far it is followed.
  if (action == Action::retract && (follows || flees)) {
    hold_in_base_ = last_pressed_in_base_ = seen.tool_in_base;
    hold_rad_ = seen.q_rad;
    const double wanted_m_per_s = flees ? blind_m_per_s : push_out_m_per_s;
    const double push_n = outward_m_per_s < wanted_m_per_s ? push_out_n : 0.0;
    return seen.gravity_nm + off_ends_nm(seen.q_rad) -
           own_joint_damping_nm_s_per_rad * seen.dq_rad_per_s +
           seen.jacobian.transpose() * (push_n * normal_in_base_);
  }
  const double lead_m = (hold_in_base_ - seen.tool_in_base).dot(normal_in_base_);
  // A person who came after the tool lies where it was pressed last, not where it was taken over.
  const double off_m = (seen.tool_in_base - last_pressed_in_base_).dot(normal_in_base_);
  if (action == Action::retract && off_m < retract_m &&
      lead_m < max_outward_n / own_stiffness_n_per_m) {
    hold_in_base_ += retract_m_per_s * options_.period_s * normal_in_base_;
  }
  // Where nothing is felt any more, what moves the tool outward may be a person who comes after it.
  const bool gives_way = pressed() || !feels();
  const double spared_m_per_s = gives_way ? std::max(outward_m_per_s, 0.0) : 0.0;
  Vector3 force_n =
      -own_damping_n_s_per_m * (seen.tool_velocity_m_per_s - spared_m_per_s * normal_in_base_);
  JointVector torque_nm = seen.gravity_nm + off_ends_nm(seen.q_rad) -
                          own_joint_damping_nm_s_per_rad * seen.dq_rad_per_s;
  if (action != Action::comply) {
    const Vector3 spring_n = own_stiffness_n_per_m * (hold_in_base_ - seen.tool_in_base);
    const double outward_n = spring_n.dot(normal_in_base_);
    const Vector3 aside_n = spring_n - outward_n * normal_in_base_;
    force_n +=
        std::clamp(outward_n, feels() ? -max_inward_n : 0.0, max_outward_n) * normal_in_base_;
    force_n += aside_n * std::min(1.0, max_outward_n / std::max(aside_n.norm(), max_outward_n));
    torque_nm += own_posture_nm_per_rad * (hold_rad_ - seen.q_rad);
  }
  // A frozen tool goes on pressing as hard as it did, and no harder than it is felt to: neither a
  // person who keeps still nor one who leaves or comes notices it.
  if (action == Action::freeze && pressed())
    force_n -= std::min(held_n_, sample_in_base_n_.dot(normal_in_base_)) * normal_in_base_;
  return torque_nm + seen.jacobian.transpose() * force_n;
}

}  // namespace tuina::safety
