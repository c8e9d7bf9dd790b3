// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/guard.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace tuina::safety {
namespace {

// Cosine between a change of torque and a pure push outward from which on it counts as letting go.
constexpr double min_outward_cosine = 0.9;
constexpr int saturated_ticks = 100;
constexpr int inward_ticks = 100;
// Excess over the cap of the inward force that is borne: a sound arm with much friction asks for as
// much without pressing harder.
constexpr double borne_over_n = 5.0;
// Newtons by which a sound controller presses harder from one millisecond to the next; in six
// massages of all three worlds it is 14 at most.
constexpr double max_step_n = 30.0;
// Newtons by which that cap falls for each newton felt beyond the set force.
constexpr double yields_per_n = 2.0;
// Newtons by which noise may make the least force felt on the way out too small.
constexpr double eases_n = 3.0;
constexpr double own_rate_factor = 10.0;  // leaving may be more sudden than pressing
constexpr double agreeing = 0.25;         // cosine between the way out and what is felt
constexpr double directed_n = 5.0;        // from here a force has a direction worth believing
constexpr double off_tip_m = 5e-3;

}  // namespace

Guard::Guard(const Options& options) noexcept : options_(options) {
  const auto lower = [](double& value, double ceiling) {
    value = value <= ceiling ? std::max(value, 0.0) : ceiling;  // NaN counts as the ceiling
  };
  for (std::size_t i = 0; i < zones; ++i) {
    ForceLimits& force = options_.force[i];
    const ForceLimits ceiling = force_ceilings[i];
    lower(force.set_n, ceiling.set_n);
    lower(force.trip_n, ceiling.trip_n - (ceiling.set_n - force.set_n));
  }
  Ceilings& limits = options_.limits;
  for (std::size_t i = 0; i < limits.tool_speed_m_per_s.size(); ++i) {
    lower(limits.tool_speed_m_per_s[i], ceilings.tool_speed_m_per_s[i]);
  }
  lower(limits.inward_m_per_s, ceilings.inward_m_per_s);
  lower(limits.pushed_out_m_per_s, ceilings.pushed_out_m_per_s);
  lower(limits.force_rate_n_per_s, ceilings.force_rate_n_per_s);
  lower(limits.over_cap_n, ceilings.over_cap_n);
  lower(limits.torque_rate_nm_per_s, ceilings.torque_rate_nm_per_s);
  lower(limits.encoder_jump_rad, ceilings.encoder_jump_rad);
  lower(limits.joint_speed_rad_per_s, ceilings.joint_speed_rad_per_s);
  lower(limits.stale_freeze_s, ceilings.stale_freeze_s);
  lower(limits.stale_retract_s, ceilings.stale_retract_s);
  lower(limits.pressing_n, ceilings.pressing_n);
  lower(limits.over_trip_n, ceilings.over_trip_n);
  lower(limits.free_inward_n, ceilings.free_inward_n);
  lower(options_.period_s, control_period_s);
  for (double& limit_nm : options_.torque_limit_nm)
    limit_nm = std::isfinite(limit_nm) ? std::max(limit_nm, 0.0) : 0.0;
  gravity_nm_ = levers_m_ = allowed_nm_ = drift_rad_ =
      JointVector::Zero(options.torque_limit_nm.size());
  spike_ages_.fill(std::numeric_limits<int>::max() / 2);
}

// The first torques may be gravity's at once; everything that is compared with the last
// millisecond begins with this one.
void Guard::begin(const Observation& seen) noexcept {
  allowed_nm_ =
      seen.gravity_nm.cwiseMin(options_.torque_limit_nm).cwiseMax(-options_.torque_limit_nm);
  q_rad_ = seen.q_rad;
  dq_rad_per_s_ = seen.dq_rad_per_s;
  tick_ = seen.tick - 1;
  time_s_ = seen.time_s - options_.period_s;
  sample_time_s_ = -std::numeric_limits<double>::infinity();
  started_ = true;
}

Verdict Guard::check(const Observation& seen, const Proposal& proposal) noexcept {
  Finding finding;
  const auto joints = options_.torque_limit_nm.size();
  const bool known =
      joints > 0 && seen.q_rad.size() == joints && seen.dq_rad_per_s.size() == joints &&
      seen.gravity_nm.size() == joints && seen.jacobian.cols() == joints &&
      seen.mass_kg_m2.cols() == joints && seen.mass_kg_m2.rows() == joints &&
      seen.q_rad.allFinite() && seen.dq_rad_per_s.allFinite() && seen.gravity_nm.allFinite() &&
      seen.jacobian.allFinite() && seen.mass_kg_m2.allFinite() && seen.tool_in_base.allFinite() &&
      seen.tool_velocity_m_per_s.allFinite() && std::isfinite(seen.time_s);
  if (!known) {
    judge_unknown(finding);
  } else {
    if (!started_) begin(seen);
    judge_time(seen, finding);
    judge_joints(seen, finding);
    judge_sensor(seen, finding);
    find_way_out(seen, proposal);
    judge_force(seen, proposal, finding);
    judge_motion(seen, proposal, finding);
    judge_proposal(seen, proposal, finding);
    judge_torques(seen, proposal, finding);
    judge_drives(seen, finding);
    judge_obedience(seen, finding);
    if (!encoders_doubted_) {
      gravity_nm_ = seen.gravity_nm;
      levers_m_ = seen.jacobian.transpose() * normal_in_base_;
    }
  }
  if (!is_stop(state_)) stopped_by_ = finding.cause;
  state_ = next_state(state_, finding.action, false);

  if (state_ == GuardState::working) {
    taken_over_ = Action::pass;
    allowed_nm_ = let_through(seen, proposal, finding);
  } else {
    const double rate = own_rate_factor * options_.limits.torque_rate_nm_per_s;
    const Action action = action_in(state_, finding.action);
    JointVector own_nm = known ? own_torque(seen, action) : blind_torque(action);
    // Told nothing, a drive that turns the other way does no more harm than a dead one.
    if (seen.drive_misfit > 1.0 && seen.reversed_joint >= 0) own_nm[seen.reversed_joint] = 0.0;
    if (motor_trial_.silenced_joint() >= 0) own_nm[motor_trial_.silenced_joint()] = 0.0;
    allowed_nm_ = limited(own_nm, rate, finding);
  }
  return {.allowed_nm = allowed_nm_,
          .action = action_in(state_, finding.action),
          .cause = is_stop(state_) ? stopped_by_ : finding.cause,
          .latched = is_stop(state_)};
}

void Guard::judge_torques(const Observation& seen, const Proposal& proposal,
                          Finding& finding) noexcept {
  const bool fits = torque_fits(proposal);
  const bool saturated =
      fits && (proposal.torque_nm.cwiseAbs() - options_.torque_limit_nm).maxCoeff() >= 0.0;
  saturated_ = saturated ? saturated_ + 1 : 0;
  if (saturated_ >= saturated_ticks) finding.add(Action::comply, Cause::torque_saturated);
  // What the controller says of its springs may be untrue; what its torques press is not.
  const double wanted_n = inward_n(seen, fits ? proposal.torque_nm : allowed_nm_);
  // A person who comes makes it jump, too, and must not be met by a tool that is held.
  const bool met =
      proposal.phase == Phase::retract || felt_n() > std::max(proposal.set_force_n, 0.0) + eases_n;
  if (!met && wanted_n - inward_n(seen, allowed_nm_) > max_step_n)
    finding.add(Action::freeze, Cause::inward_force);
  const double over_n = wanted_n - inward_cap_n(seen, proposal);
  inward_ = over_n > borne_over_n ? inward_ + 1 : 0;
  if (over_n > 0.0) finding.add(Action::warn, Cause::inward_force);
  if (inward_ >= inward_ticks) finding.add(Action::retract, Cause::inward_force);
}

// Torques are asked how hard they press before they are limited, and after: joints that reach what
// is proposed one after the other can press harder on the way than at its end.
JointVector Guard::let_through(const Observation& seen, const Proposal& proposal,
                               Finding& finding) const noexcept {
  const double cap_n = inward_cap_n(seen, proposal);
  const JointVector outward = seen.jacobian.transpose() * normal_in_base_;
  const auto over_n = [&](const JointVector& torque_nm) {
    return std::max(inward_n(seen, torque_nm) - cap_n, 0.0);
  };
  JointVector torque_nm = torque_fits(proposal) ? proposal.torque_nm : allowed_nm_;
  double rate = options_.limits.torque_rate_nm_per_s;
  const bool may_press = proposal.phase == Phase::contact || proposal.phase == Phase::retract;
  if (may_press && pushes_outward(seen, torque_nm)) rate *= own_rate_factor;
  torque_nm = limited(torque_nm + over_n(torque_nm) * outward, rate, finding);
  rate = own_rate_factor * options_.limits.torque_rate_nm_per_s;
  return limited(torque_nm + over_n(torque_nm) * outward, rate, finding);
}

bool Guard::torque_fits(const Proposal& proposal) const noexcept {
  return proposal.torque_nm.size() == options_.torque_limit_nm.size() &&
         proposal.torque_nm.allFinite();
}

// The way out of a body that the guard knows is its own. Else it is what the controller says, but
// a tool that is pushed is not turned against what pushes it; and once latched it stays. A tool
// that leaves keeps the way out of where it was: over the rim of a back, a hand's breadth above the
// skin, lies skin that faces aside.
void Guard::find_way_out(const Observation& seen, const Proposal& proposal) noexcept {
  if (is_stop(state_)) return;
  if (proposal.phase == Phase::retract && above_where_it_left(seen)) return;
  left_at_in_base_ = seen.tool_in_base;
  if (seen.skin != nullptr && is_unit(seen.skin->normal_in_base.cast<double>())) {
    normal_in_base_ = seen.skin->normal_in_base.cast<double>();
    return;
  }
  const double force_n = sample_in_base_n_.norm();
  const double outward_n = sample_in_base_n_.dot(proposal.normal_in_base);
  const bool agrees = force_n < directed_n || outward_n > agreeing * force_n;
  if (is_unit(proposal.normal_in_base) && agrees) normal_in_base_ = proposal.normal_in_base;
}

// Within a cone about that way out; the tool may begin some millimetres off its tip.
bool Guard::above_where_it_left(const Observation& seen) const noexcept {
  const Vector3 way_m = seen.tool_in_base - left_at_in_base_;
  const double out_m = way_m.dot(normal_in_base_);
  return out_m + off_tip_m > (way_m - out_m * normal_in_base_).norm();
}

// A zone that does not exist, or one that is not for people, is borne as the most careful one is;
// what the guard knows of the place can only lower the limits of what it is told.
ForceLimits Guard::limits_of(const Observation& seen, const Proposal& proposal) const noexcept {
  const auto limits_in = [&](Zone zone) {
    const bool usable =
        static_cast<std::size_t>(zone) < zones && (zone != Zone::bench || options_.bench);
    return options_.force[static_cast<std::size_t>(usable ? zone : Zone::denied)];
  };
  const ForceLimits told = limits_in(proposal.zone);
  if (seen.skin == nullptr) return told;
  const ForceLimits here = limits_in(seen.skin->zone);
  return {std::min(told.set_n, here.set_n), std::min(told.trip_n, here.trip_n)};
}

// A sound controller presses less where it feels more, so torques that press on are not its own.
// But a hand that leads an arm without a spring asks for no force, and a bench is nobody.
double Guard::inward_cap_n(const Observation& seen, const Proposal& proposal) const noexcept {
  const Ceilings& limits = options_.limits;
  if (proposal.phase == Phase::free) return limits.free_inward_n;
  if (proposal.phase == Phase::retract)
    return std::min(std::max(min_felt_n_ + eases_n, limits.pressing_n), limits.free_inward_n);
  const double place_n = limits_of(seen, proposal).trip_n + limits.over_trip_n;
  if (proposal.stiffness_n_per_m == 0.0 || proposal.zone == Zone::bench) return place_n;
  const double set_n = std::max(0.0, proposal.set_force_n);
  const double over_n = std::max(felt_n() - set_n, 0.0);
  return std::max(std::min(set_n + limits.pressing_n, place_n) - yields_per_n * over_n, 0.0);
}

// The force inward with which the body would have to hold the tool still along the normal: the
// acceleration that the torques give it there, times the mass that it shows there.
double Guard::inward_n(const Observation& seen, const JointVector& torque_nm) const noexcept {
  const JointVector lever = seen.jacobian.transpose() * normal_in_base_;
  const JointVector yields = seen.mass_kg_m2.llt().solve(lever);
  const double mobility_per_kg = lever.dot(yields);
  const double force_n = yields.dot(seen.gravity_nm - torque_nm) / mobility_per_kg;
  return std::isfinite(force_n) ? force_n : 0.0;  // a tool that no joint moves presses nobody
}

// A change of torque that is nearly all a force along the outward normal is somebody letting go.
bool Guard::pushes_outward(const Observation& seen, const JointVector& torque_nm) const noexcept {
  const JointVector change_nm = torque_nm - allowed_nm_;
  const JointVector outward = seen.jacobian.transpose() * normal_in_base_;
  return outward.dot(change_nm) > min_outward_cosine * outward.norm() * change_nm.norm();
}

JointVector Guard::limited(const JointVector& torque_nm, double rate_nm_per_s,
                           Finding& finding) const noexcept {
  const double step_nm = rate_nm_per_s * options_.period_s;
  JointVector allowed = torque_nm;
  for (Eigen::Index i = 0; i < allowed.size(); ++i) {
    const double limit = options_.torque_limit_nm[i];
    const double wanted = std::isfinite(allowed[i]) ? allowed[i] : allowed_nm_[i];
    const double clamped = std::clamp(wanted, -limit, limit);
    if (clamped != wanted) finding.add(Action::warn, Cause::torque_clamped);
    allowed[i] = std::clamp(clamped, allowed_nm_[i] - step_nm, allowed_nm_[i] + step_nm);
    if (allowed[i] != clamped) finding.add(Action::warn, Cause::torque_rate_clamped);
  }
  return allowed;
}

}  // namespace tuina::safety
