// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/guard.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::safety {
namespace {

// A real contact cannot change the wrist's force by this much in a millisecond: the sensor's filter
// alone spreads a blow over ten. A jump is a fault of the sensor until a third sample says the
// same.
constexpr double spike_n = 25.0;
constexpr int believed_after = 3;
constexpr double spikes_window_s = 1.0;

constexpr int fast_ticks = 3;  // encoder noise reaches one or two
constexpr int rising_ticks = 3;
constexpr int over_cap_ticks = 100;
constexpr int saturated_ticks = 100;
constexpr int bad_torques = 3;
constexpr double late_freeze_s = 0.1;

// The guard's own law: soft enough to be safe on any tissue, damped enough to stop a moving arm.
constexpr double own_stiffness_n_per_m = 800.0;
constexpr double own_damping_n_s_per_m = 60.0;
constexpr double own_posture_nm_per_rad = 4.0;
constexpr double own_joint_damping = 0.8;  // N m s / rad
constexpr double retract_m_per_s = 0.1;
constexpr double retract_m = 0.06;
constexpr double max_inward_n = 5.0;
constexpr double max_outward_n = 40.0;
constexpr double pressed_n = 5.0;  // from here the person is still in the way of leaving
constexpr double push_out_n = 80.0;
constexpr double push_out_m_per_s = 0.25;
constexpr double mostly = 0.9;
constexpr double own_rate_factor = 10.0;  // leaving may be more sudden than pressing

/// False for a vector that is not finite, too.
bool is_unit(const Vector3& normal) {
  return std::abs(normal.norm() - 1.0) < 1e-3;
}

double median(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

Guard::Guard(const Options& options) noexcept : options_(options) {
  const auto lower = [](double& value, double ceiling) {
    value = value <= ceiling ? std::max(value, 0.0) : ceiling;  // NaN counts as the ceiling
  };
  for (std::size_t i = 0; i < zones; ++i) {
    lower(options_.force[i].set_n, force_ceilings[i].set_n);
    lower(options_.force[i].trip_n, force_ceilings[i].trip_n);
  }
  Ceilings& limits = options_.limits;
  for (std::size_t i = 0; i < limits.tool_speed_m_per_s.size(); ++i) {
    lower(limits.tool_speed_m_per_s[i], ceilings.tool_speed_m_per_s[i]);
  }
  lower(limits.pushed_out_m_per_s, ceilings.pushed_out_m_per_s);
  lower(limits.force_rate_n_per_s, ceilings.force_rate_n_per_s);
  lower(limits.over_cap_n, ceilings.over_cap_n);
  lower(limits.torque_rate_nm_per_s, ceilings.torque_rate_nm_per_s);
  lower(limits.encoder_jump_rad, ceilings.encoder_jump_rad);
  lower(limits.joint_speed_rad_per_s, ceilings.joint_speed_rad_per_s);
  lower(limits.stale_freeze_s, ceilings.stale_freeze_s);
  lower(limits.stale_retract_s, ceilings.stale_retract_s);
  gravity_nm_ = allowed_nm_ = JointVector::Zero(options.torque_limit_nm.size());
  spike_times_s_.fill(-std::numeric_limits<double>::infinity());
}

void Guard::reset() noexcept {
  const Vector3 way_out_in_base = normal_in_base_;  // the last one known stays the best guess
  *this = Guard(options_);
  normal_in_base_ = way_out_in_base;
}

Verdict Guard::check(const Observation& seen, const Proposal& proposal) noexcept {
  Finding finding;
  const auto joints = options_.torque_limit_nm.size();
  const bool known = seen.q_rad.size() == joints && seen.dq_rad_per_s.size() == joints &&
                     seen.gravity_nm.size() == joints && seen.jacobian.cols() == joints &&
                     seen.q_rad.allFinite() && seen.dq_rad_per_s.allFinite() &&
                     seen.gravity_nm.allFinite() && seen.jacobian.allFinite() &&
                     seen.tool_in_base.allFinite() && seen.tool_velocity_m_per_s.allFinite() &&
                     std::isfinite(seen.time_s);
  if (!known) {
    finding.add(Action::brake, Cause::state_not_finite, true);
  } else {
    if (!started_) {
      allowed_nm_ =
          seen.gravity_nm.cwiseMin(options_.torque_limit_nm).cwiseMax(-options_.torque_limit_nm);
      const double force_n = seen.force_in_base_n.norm();
      samples_n_.fill(std::isfinite(force_n) ? force_n : 0.0);
      medians_n_.fill(samples_n_[0]);
      q_rad_ = seen.q_rad;
      last_force_time_s_ = seen.time_s;
      tick_ = seen.tick - 1;
      started_ = true;
    }
    // Once latched, the way out is the guard's own: the controller cannot turn it round.
    if (latched_ == Action::pass && is_unit(proposal.normal_in_base))
      normal_in_base_ = proposal.normal_in_base;
    judge_time(seen, finding);
    judge_joints(seen, finding);
    judge_force(seen, proposal, finding);
    judge_motion(seen, proposal, finding);
    judge_proposal(seen, proposal, finding);
    gravity_nm_ = seen.gravity_nm;
  }
  if (finding.latches && finding.action > latched_) {
    latched_ = finding.action;
    latched_cause_ = latched_cause_ == Cause::none ? finding.cause : latched_cause_;
  }
  if (latched_ >= finding.action) finding.action = latched_, finding.cause = latched_cause_;

  const bool proposal_fits = proposal.torque_nm.size() == joints && proposal.torque_nm.allFinite();
  JointVector torque_nm = proposal_fits ? proposal.torque_nm : allowed_nm_;
  double rate = options_.limits.torque_rate_nm_per_s;
  if (finding.action >= Action::freeze) {
    torque_nm = own_torque(seen, finding.action);
    rate *= own_rate_factor;
  } else {
    taken_over_ = Action::pass;
    if (proposal.phase == Phase::contact && pushes_outward(seen, torque_nm))
      rate *= own_rate_factor;
  }
  allowed_nm_ = limited(torque_nm, rate, finding);
  return {allowed_nm_, finding.action, finding.cause, latched_ != Action::pass};
}

// A late tick is survived by holding the last torques; one that is very late by leaving.
void Guard::judge_time(const Observation& seen, Finding& finding) noexcept {
  const std::uint64_t expected = tick_ + 1;
  tick_ = seen.tick;
  if (seen.tick != expected) {
    const std::uint64_t missed = seen.tick - expected;  // going backwards counts as very many
    finding.add(Action::warn, Cause::late_tick, false);
    if (missed >= 10) finding.add(Action::retract, Cause::late_tick, true);
    if (missed >= 3) frozen_until_s_ = seen.time_s + late_freeze_s;
  }
  if (seen.time_s < frozen_until_s_) finding.add(Action::freeze, Cause::late_tick, false);
}

void Guard::judge_joints(const Observation& seen, Finding& finding) noexcept {
  const double jump = (seen.q_rad - q_rad_).cwiseAbs().maxCoeff();
  q_rad_ = seen.q_rad;
  if (jump > options_.limits.encoder_jump_rad)
    finding.add(Action::comply, Cause::encoder_jump, true);
  constexpr Eigen::Index carry_forearm = 4;  // three of the shoulder, and the elbow
  const auto carrying = seen.dq_rad_per_s.head(std::min(seen.q_rad.size(), carry_forearm));
  const double joint_speed = carrying.cwiseAbs().maxCoeff();
  swinging_ = joint_speed > options_.limits.joint_speed_rad_per_s ? swinging_ + 1 : 0;
  if (swinging_ >= fast_ticks) finding.add(Action::comply, Cause::joint_too_fast, true);
}

void Guard::judge_force(const Observation& seen, const Proposal& proposal,
                        Finding& finding) noexcept {
  const double force_n = seen.force_in_base_n.norm();
  const bool sane = std::isfinite(force_n) && std::isfinite(seen.wrench_time_s) &&
                    seen.wrench_time_s <= seen.time_s + 1e-6;
  if (sane) {
    const bool suspect =
        std::abs(force_n - samples_n_[2]) > spike_n && suspects_ < believed_after - 1;
    if (suspect) {
      if (suspects_++ == 0) {
        std::rotate(spike_times_s_.begin(), spike_times_s_.begin() + 1, spike_times_s_.end());
        spike_times_s_.back() = seen.time_s;
      }
      finding.add(Action::warn, Cause::force_spike, false);
    } else {
      suspects_ = 0;
      samples_n_ = {samples_n_[1], samples_n_[2], force_n};
    }
    last_force_time_s_ = std::max(last_force_time_s_, seen.wrench_time_s);
  }
  if (seen.time_s - spike_times_s_.front() < spikes_window_s) {
    finding.add(Action::retract, Cause::force_spikes, true);
  }
  const double age_s = seen.time_s - last_force_time_s_ - 1e-6;  // rounding of the clocks
  if (age_s > options_.limits.stale_freeze_s)
    finding.add(Action::freeze, Cause::force_stale, false);
  if (age_s > options_.limits.stale_retract_s)
    finding.add(Action::retract, Cause::force_stale, true);
  std::rotate(medians_n_.begin(), medians_n_.begin() + 1, medians_n_.end());
  medians_n_.back() = median(samples_n_[0], samples_n_[1], samples_n_[2]);
  const ForceLimits limits =
      options_.force[std::min(static_cast<std::size_t>(proposal.zone), zones - 1)];
  const double now_n = medians_n_.back();
  const double rate = (now_n - medians_n_.front()) / (5.0 * options_.period_s);
  rising_ = rate > options_.limits.force_rate_n_per_s ? rising_ + 1 : 0;
  if (rising_ >= rising_ticks) finding.add(Action::retract, Cause::force_rising, true);
  over_cap_ = now_n > limits.set_n + options_.limits.over_cap_n ? over_cap_ + 1 : 0;
  if (over_cap_ >= over_cap_ticks) finding.add(Action::retract, Cause::force_over_cap, true);
  if (now_n > limits.trip_n) finding.add(Action::retract, Cause::force_over_trip, true);
}

void Guard::judge_motion(const Observation& seen, const Proposal& proposal,
                         Finding& finding) noexcept {
  const auto phase = std::min(static_cast<std::size_t>(proposal.phase), std::size_t{3});
  const double speed = seen.tool_velocity_m_per_s.norm();
  too_fast_ = speed > options_.limits.tool_speed_m_per_s[phase] ? too_fast_ + 1 : 0;
  if (too_fast_ >= fast_ticks) finding.add(Action::comply, Cause::tool_too_fast, true);
  const double outward = seen.tool_velocity_m_per_s.dot(normal_in_base_);
  const bool pushed =
      proposal.phase == Phase::contact && outward > options_.limits.pushed_out_m_per_s;
  pushed_out_ = pushed ? pushed_out_ + 1 : 0;
  if (pushed_out_ >= fast_ticks) finding.add(Action::retract, Cause::pushed_out, true);
}

void Guard::judge_proposal(const Observation& seen, const Proposal& proposal,
                           Finding& finding) noexcept {
  const auto joints = options_.torque_limit_nm.size();
  const bool torque_fits = proposal.torque_nm.size() == joints && proposal.torque_nm.allFinite();
  not_finite_ = torque_fits ? 0 : not_finite_ + 1;
  if (!torque_fits) finding.add(Action::warn, Cause::torque_not_finite, false);
  if (not_finite_ >= bad_torques) finding.add(Action::retract, Cause::torque_not_finite, true);
  const auto zone = static_cast<std::size_t>(proposal.zone);
  const bool usable =
      zone < zones && static_cast<std::size_t>(proposal.phase) <= 3 &&
      is_unit(proposal.normal_in_base) && proposal.virtual_target_in_base.allFinite() &&
      std::isfinite(proposal.stiffness_n_per_m) && proposal.stiffness_n_per_m >= 0.0;
  if (!usable) {
    finding.add(Action::retract, Cause::bad_proposal, true);
    return;
  }
  // The force that the springs can build up against a person who rises, whatever the sensor says.
  const ForceLimits limits = options_.force[zone];
  const Vector3 leash_m = proposal.virtual_target_in_base - seen.tool_in_base;
  const double pull_n = -leash_m.dot(normal_in_base_) * proposal.stiffness_n_per_m;
  if (proposal.phase == Phase::contact && pull_n > limits.trip_n) {
    finding.add(Action::retract, Cause::leash_too_long, true);
  }
  if (!(proposal.set_force_n <= limits.set_n)) {
    finding.add(Action::retract, Cause::set_force_too_high, true);
  }
  const bool saturated =
      torque_fits && (proposal.torque_nm.cwiseAbs() - options_.torque_limit_nm).maxCoeff() > 0.0;
  saturated_ = saturated ? saturated_ + 1 : 0;
  if (saturated_ >= saturated_ticks) finding.add(Action::comply, Cause::torque_saturated, true);
}

JointVector Guard::own_torque(const Observation& seen, Action action) noexcept {
  if (action == Action::brake) return gravity_nm_;
  if (taken_over_ != action) {
    taken_over_ = action;
    hold_in_base_ = taken_over_in_base_ = seen.tool_in_base;
    hold_rad_ = seen.q_rad;
  }
  // Friction and a person who follows may hold the tool back, so the way is the tool's own.
  const double way_m = (seen.tool_in_base - taken_over_in_base_).dot(normal_in_base_);
  const double lead_m = (hold_in_base_ - seen.tool_in_base).dot(normal_in_base_);
  if (action == Action::retract && way_m < retract_m &&
      lead_m < max_outward_n / own_stiffness_n_per_m) {
    hold_in_base_ += retract_m_per_s * options_.period_s * normal_in_base_;
  }
  // A person who comes after the tool is met by nothing that holds it in place.
  const double outward_m_per_s = seen.tool_velocity_m_per_s.dot(normal_in_base_);
  const bool pressed = medians_n_.back() > pressed_n && way_m < retract_m;
  const double spared_m_per_s = pressed ? std::max(outward_m_per_s, 0.0) : 0.0;
  const Vector3 braked_m_per_s = seen.tool_velocity_m_per_s - spared_m_per_s * normal_in_base_;
  Vector3 force_n = -own_damping_n_s_per_m * braked_m_per_s;
  JointVector torque_nm = seen.gravity_nm - own_joint_damping * seen.dq_rad_per_s;
  if (action != Action::comply) {
    Vector3 spring_n = own_stiffness_n_per_m * (hold_in_base_ - seen.tool_in_base);
    const double outward_n = spring_n.dot(normal_in_base_);
    spring_n += (std::clamp(outward_n, -max_inward_n, max_outward_n) - outward_n) * normal_in_base_;
    force_n += spring_n;
    if (action == Action::retract && pressed && outward_m_per_s < push_out_m_per_s)
      force_n += (push_out_n - force_n.dot(normal_in_base_)) * normal_in_base_;
    torque_nm += own_posture_nm_per_rad * (hold_rad_ - seen.q_rad);
  }
  return torque_nm + seen.jacobian.transpose() * force_n;
}

// A change of torque that is nearly all a force along the outward normal is somebody letting go.
bool Guard::pushes_outward(const Observation& seen, const JointVector& torque_nm) const noexcept {
  const JointVector change_nm = torque_nm - allowed_nm_;
  const JointVector outward = seen.jacobian.transpose() * normal_in_base_;
  return outward.dot(change_nm) > mostly * outward.norm() * change_nm.norm();
}

JointVector Guard::limited(const JointVector& torque_nm, double rate_nm_per_s,
                           Finding& finding) const noexcept {
  const double step_nm = rate_nm_per_s * options_.period_s;
  JointVector allowed = torque_nm;
  for (Eigen::Index i = 0; i < allowed.size(); ++i) {
    const double limit = options_.torque_limit_nm[i];
    const double wanted = std::isfinite(allowed[i]) ? allowed[i] : allowed_nm_[i];
    const double clamped = std::clamp(wanted, -limit, limit);
    if (clamped != wanted) finding.add(Action::warn, Cause::torque_clamped, false);
    allowed[i] = std::clamp(clamped, allowed_nm_[i] - step_nm, allowed_nm_[i] + step_nm);
    if (allowed[i] != clamped) finding.add(Action::warn, Cause::torque_rate_clamped, false);
  }
  return allowed;
}

}  // namespace tuina::safety
