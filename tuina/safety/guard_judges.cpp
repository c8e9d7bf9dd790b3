// SPDX-License-Identifier: Apache-2.0
// What a guard looks for in each millisecond: one function for each thing that can be amiss.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/safety/guard.hpp"

namespace tuina::safety {
namespace {

// A real contact cannot change the wrist's force by this much in a millisecond: the sensor's filter
// alone spreads a blow over ten. A jump is a fault of the sensor until a third sample says the
// same.
constexpr double spike_n = 25.0;
constexpr int believed_after = 3;
constexpr int spikes_window_ticks = 1000;
constexpr int first_samples = 3;  // until then one wild sample would be all that is known

constexpr int repeated_ticks = 3;
constexpr int clock_ticks = 3;
constexpr int fast_ticks = 3;  // encoder noise reaches one or two
// Limits within which a tool may go outward though the person does not get up: the way of a cough;
// the force above the set force up to which the tool merely rides on the skin; the outward push of
// the proposed torques from which on the controller itself is escaping.
constexpr double coughed_m = 20e-3, rides_n = 10.0, escape_n = 40.0;
// Limits of a tool that flies after an escape: farther than a person who sits up comes, and as fast
// as the controller's push and the person together make it.
constexpr double flight_m = 0.25, flight_m_per_s = 1.3;
constexpr int rising_ticks = 3;
constexpr int over_cap_ticks = 100;
constexpr int bad_torques = 3;
constexpr int late_freeze_ticks = 100;
constexpr std::uint32_t silent_freeze_ticks = 3;
constexpr std::uint32_t silent_retract_ticks = 10;
constexpr std::uint64_t too_many_missed = 10;
constexpr double telling_rad_per_s = 1e-3;  // a change of speed that every controller answers

// Share that is kept from tick to tick of the summed difference between angles and joint speeds, a
// memory of 50 ms: the speeds are filtered, lag by some milliseconds and make up for it within that
// time. A difference that lasts is a fault of the encoder. It is noticed from 0.2 rad/s on, which
// moves the tool of a stretched arm as fast as an approach may be.
constexpr double drift_kept = 0.98;

constexpr int blamed_ticks = 5;
constexpr double returning_m_per_s = 0.05, flying_off_m_per_s = 0.35;
constexpr double max_zero_jump_n = 1.2;  // the weight of the lightest tool is 1.5 N

constexpr double reversed_n = 8.0;  // more than drift and weight can feign
constexpr double agreeing = 0.25;  // cosine: what rubs along the skin is felt at 40 degrees at most
constexpr int reversed_ticks = 10;

// A blind arm gives way with its joints damped. It is held once nobody is felt, or where it stands
// still: brakes before a person who comes are a wall, and nobody has come for longer than 2 s.
constexpr int blind_ticks = 300, max_blind_ticks = 2000;
constexpr double resting_rad_per_s = 0.05;
constexpr double let_go_n = 2.0;

double median(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

bool is_unit(const Vector3& normal) noexcept {
  return std::abs(normal.norm() - 1.0) < 1e-3;
}

// A late tick is survived by holding the last torques; one that is very late by leaving. The clock
// may jump once, when somebody sets it; a clock that goes on being wrong is broken.
void Guard::judge_time(const Observation& seen, Finding& finding) noexcept {
  const std::uint64_t gone = seen.tick - tick_;  // going backwards counts as very many
  // Only a tick that follows the last one ends a row of repeated ones: between them some are
  // missed.
  if (gone <= 1) repeated_ = gone == 0 ? repeated_ + 1 : 0;
  ticks_ = std::clamp<std::uint64_t>(gone, 1, too_many_missed + 1);
  tick_ = seen.tick;
  frozen_ -= std::min(frozen_, static_cast<int>(ticks_));
  if (gone != 1) finding.add(Action::warn, Cause::late_tick);
  if (gone > too_many_missed || repeated_ >= repeated_ticks)
    finding.add(Action::retract, Cause::late_tick);
  if (gone > 3) frozen_ = late_freeze_ticks;
  if (frozen_ > 0) finding.add(Action::freeze, Cause::late_tick);

  const double expected_s = static_cast<double>(gone) * options_.period_s;
  const double passed_s = seen.time_s - time_s_;
  time_s_ = seen.time_s;
  const bool odd =
      !(std::abs(passed_s - expected_s) <= 0.5 * std::max(expected_s, options_.period_s));
  clock_ = odd ? clock_ + 1 : 0;
  if (odd) sample_time_s_ += passed_s - expected_s;  // the sensor's stamps have jumped with it
  if (clock_ >= clock_ticks) finding.add(Action::retract, Cause::clock);
}

void Guard::judge_joints(const Observation& seen, Finding& finding) noexcept {
  const double ticks = static_cast<double>(ticks_);
  // After a silence that ends a contact, a joint may stand anywhere: it has not jumped.
  const JointVector told_rad = ticks * options_.period_s * seen.dq_rad_per_s;
  const JointVector turned_rad =
      ticks_ > too_many_missed ? told_rad : JointVector(seen.q_rad - q_rad_);
  q_rad_ = seen.q_rad;
  const double jump_rad = turned_rad.cwiseAbs().maxCoeff();
  drift_rad_ = drift_kept * drift_rad_ + turned_rad - told_rad;
  const double drift_rad = drift_rad_.cwiseAbs().maxCoeff();
  const double limit_rad = ticks * options_.limits.encoder_jump_rad;
  if (jump_rad > limit_rad || drift_rad > 2.0 * limit_rad) {
    finding.add(Action::comply, Cause::encoder_jump);
    pressed_at_doubt_ = encoders_doubted_ ? pressed_at_doubt_ : pressed();
    encoders_doubted_ = true;
  }
  constexpr Eigen::Index carry_forearm = 4;  // three of the shoulder, and the elbow
  const auto carrying = seen.dq_rad_per_s.head(std::min(seen.q_rad.size(), carry_forearm));
  const double joint_speed = carrying.cwiseAbs().maxCoeff();
  const bool swings = joint_speed > options_.limits.joint_speed_rad_per_s && !flies_;
  swinging_ = swings ? swinging_ + 1 : 0;
  if (swinging_ >= fast_ticks) finding.add(Action::comply, Cause::joint_too_fast);
  if (!encoders_doubted_) return;
  ++blind_;
  const bool let_go = blind_ > fast_ticks && !leaves_in_doubt() && medians_n_.back() < let_go_n;
  const bool rests =
      blind_ > blind_ticks && seen.dq_rad_per_s.cwiseAbs().maxCoeff() < resting_rad_per_s;
  if (let_go || rests || blind_ > max_blind_ticks) finding.add(Action::brake, Cause::encoder_jump);
}

// Torques that do not move the joints as they should: where one drive is to blame and nothing
// touches the tool, the brakes are all that is left to trust. But a tool that flies off faster than
// any order, or that is stopped already, may have a person behind it who follows: it is braked only
// on its way back to the body. Else somebody may be leading the arm, and on a person who breathes
// brakes would be a wall.
void Guard::judge_drives(const Observation& seen, Finding& finding) noexcept {
  const bool amiss = seen.torque_misfit > 1.0, measured = seen.drive_misfit > 1.0;
  const bool stopped = is_stop(state_);
  const double outward_m_per_s = seen.tool_velocity_m_per_s.dot(normal_in_base_);
  const bool clear = outward_m_per_s < (stopped ? -returning_m_per_s : flying_off_m_per_s);
  // A drive that is told nothing any more gives what it is told, and is broken all the same.
  const bool known_broken = motor_trial_.silenced_joint() >= 0 || stopped_by_ == Cause::drive_amiss;
  const bool blamed = measured || known_broken || (amiss && seen.weak_joint >= 0);
  drive_amiss_ = blamed && in_air() && clear ? drive_amiss_ + 1 : 0;
  if (drive_amiss_ > (stopped ? blamed_ticks : 0)) finding.add(Action::brake, Cause::drive_amiss);
  if (measured) finding.add(Action::comply, Cause::drive_amiss);
  if (amiss) finding.add(Action::comply, Cause::torques_amiss);
  // A trial changes what the arm does, so it waits until the guard has the arm.
  motor_trial_.look(seen.unexplained_nm, allowed_nm_, stopped && amiss ? seen.weak_joint : -1);
}

void Guard::take_sample(const Observation& seen, Finding& finding) noexcept {
  const double force_n = seen.force_in_base_n.norm();
  const bool stuck = seen.wrist_repeats > max_wrist_repeats;
  if (stuck) finding.add(Action::retract, Cause::force_stuck);
  if (seen.wrist_stepped) finding.add(Action::retract, Cause::force_off_zero);
  force_doubted_ = force_doubted_ || stuck || seen.wrist_stepped;
  // An arm that believes in another weight than its tool has sinks or rises by every law, so it is
  // braked unless it presses somebody.
  if (seen.zero_jump_n > max_zero_jump_n)
    finding.add(pressed() ? Action::retract : Action::brake, Cause::force_off_zero);
  const bool suspect = samples_ >= first_samples && std::abs(force_n - samples_n_[2]) > spike_n &&
                       suspects_ < believed_after - 1;
  if (suspect) {
    if (suspects_++ == 0) {
      std::rotate(spike_ages_.begin(), spike_ages_.begin() + 1, spike_ages_.end());
      spike_ages_.back() = 0;
    }
    finding.add(Action::warn, Cause::force_spike);
    return;
  }
  suspects_ = 0;
  sample_in_base_n_ = seen.force_in_base_n;
  samples_n_ = {samples_n_[1], samples_n_[2], force_n};
  samples_ = std::min(samples_ + 1, first_samples);
}

// A sample is new when its stamp is: one that is sent again, or comes from another time, is none.
void Guard::judge_sensor(const Observation& seen, Finding& finding) noexcept {
  const int ticks = static_cast<int>(ticks_);
  sample_age_s_ += ticks * options_.period_s;
  for (int& age : spike_ages_) age = std::min(age, spikes_window_ticks) + ticks;
  const double age_s = seen.time_s - seen.wrench_time_s;
  const bool fresh = seen.force_in_base_n.allFinite() && seen.wrench_time_s > sample_time_s_ &&
                     std::abs(age_s) <= options_.limits.stale_retract_s;
  const bool begins = samples_ < first_samples;
  if (fresh) {
    sample_time_s_ = seen.wrench_time_s;
    sample_age_s_ = std::max(age_s, 0.0);
    take_sample(seen, finding);
  }
  if (spike_ages_.front() < spikes_window_ticks) finding.add(Action::retract, Cause::force_spikes);
  const double rounding_s = 1e-6;
  if (sample_age_s_ > options_.limits.stale_freeze_s + rounding_s)
    finding.add(Action::freeze, Cause::force_stale);
  if (sample_age_s_ > options_.limits.stale_retract_s + rounding_s)
    finding.add(Action::retract, Cause::force_stale);
  const double median_n = median(samples_n_[0], samples_n_[1], samples_n_[2]);
  if (feels()) believed_n_ = median_n;
  if (begins) return medians_n_.fill(median_n);
  std::rotate(medians_n_.begin(), medians_n_.begin() + 1, medians_n_.end());
  medians_n_.back() = median_n;
}

void Guard::judge_force(const Observation& seen, const Proposal& proposal,
                        Finding& finding) noexcept {
  const bool leaves = state_ == GuardState::retracting || proposal.phase == Phase::retract;
  min_felt_n_ = leaves ? std::min(min_felt_n_, felt_n()) : std::numeric_limits<double>::infinity();
  if (samples_ < first_samples) return;
  const ForceLimits limits = limits_of(seen, proposal);
  const double now_n = medians_n_.back();
  const double rate = (now_n - medians_n_.front()) / (5.0 * options_.period_s);
  rising_ = rate > options_.limits.force_rate_n_per_s ? rising_ + 1 : 0;
  if (rising_ >= rising_ticks) finding.add(Action::retract, Cause::force_rising);
  over_cap_ = now_n > limits.set_n + options_.limits.over_cap_n ? over_cap_ + 1 : 0;
  if (over_cap_ >= over_cap_ticks) finding.add(Action::retract, Cause::force_over_cap);
  if (now_n > limits.trip_n) finding.add(Action::retract, Cause::force_over_trip);
  // Either the sensor or the way out is wrong. Where the way out is the guard's own, it is the
  // sensor; else no law that trusts one of them may drive.
  const bool touches = proposal.phase == Phase::contact || proposal.phase == Phase::approach;
  const double outward_n = sample_in_base_n_.dot(normal_in_base_);
  const bool reversed = touches && now_n > reversed_n && outward_n < agreeing * now_n;
  reversed_ = reversed ? reversed_ + 1 : 0;
  if (reversed_ >= reversed_ticks) {
    finding.add(seen.skin != nullptr ? Action::retract : Action::comply, Cause::force_reversed);
    force_doubted_ = true;
  }
}

// A cough takes the tool along for some millimetres, and its controller may drive it out of one.
// Who gets up goes farther; nothing slows a tool down before them that leaves, pressed by them.
void Guard::judge_motion(const Observation& seen, const Proposal& proposal,
                         Finding& finding) noexcept {
  const auto phase = std::min(static_cast<std::size_t>(proposal.phase), std::size_t{3});
  const double outward = seen.tool_velocity_m_per_s.dot(normal_in_base_);
  const bool touches = proposal.phase == Phase::contact;
  const bool leaves = proposal.phase == Phase::retract;
  const bool out = outward > options_.limits.pushed_out_m_per_s;
  pushed_out_ = out && touches ? pushed_out_ + 1 : 0;
  pushed_out_m_ = out ? pushed_out_m_ + outward * options_.period_s : 0.0;
  const bool soon_over = out && pushed_out_m_ <= coughed_m;
  const bool rides = soon_over && medians_n_.back() < proposal.set_force_n + rides_n;
  const bool driven_out =
      touches && torque_fits(proposal) && inward_n(seen, proposal.torque_nm) < -escape_n;
  fled_ = outward > 0.0 && (fled_ || pressed());
  flies_ = leaves && out && fled_ && pushed_out_m_ <= flight_m && outward <= flight_m_per_s;
  const bool escapes = flies_ || (soon_over && (driven_out || leaves));
  if (pushed_out_ >= fast_ticks && !rides && !escapes)
    finding.add(Action::retract, Cause::pushed_out);

  const Vector3 judged_m_per_s =
      seen.tool_velocity_m_per_s - (escapes ? outward : 0.0) * normal_in_base_;
  const bool fast = judged_m_per_s.norm() > options_.limits.tool_speed_m_per_s[phase] ||
                    (touches && -outward > options_.limits.inward_m_per_s);
  too_fast_ = fast ? too_fast_ + 1 : 0;
  if (too_fast_ >= fast_ticks) finding.add(Action::comply, Cause::tool_too_fast);
}

// Torques that stay the same to the last bit while the speeds of the joints change were proposed
// for the first of them: nobody proposes any more.
std::uint32_t Guard::silent_ticks(const Observation& seen, const Proposal& proposal) noexcept {
  const JointVector change = seen.dq_rad_per_s - dq_rad_per_s_;
  dq_rad_per_s_ = seen.dq_rad_per_s;
  const bool same = proposal.torque_nm.size() == told_nm_.size() && proposal.torque_nm == told_nm_;
  told_nm_ = proposal.torque_nm;
  if (!same) same_ = 0;
  if (same && change.cwiseAbs().maxCoeff() > telling_rad_per_s) ++same_;
  return std::max(proposal.age_ticks, same_);
}

void Guard::judge_proposal(const Observation& seen, const Proposal& proposal,
                           Finding& finding) noexcept {
  const std::uint32_t silent = silent_ticks(seen, proposal);
  if (silent >= silent_freeze_ticks) finding.add(Action::freeze, Cause::no_proposal);
  if (silent >= silent_retract_ticks) finding.add(Action::retract, Cause::no_proposal);
  const bool fits = torque_fits(proposal);
  not_finite_ = fits ? 0 : not_finite_ + 1;
  if (!fits) finding.add(Action::warn, Cause::torque_not_finite);
  if (not_finite_ >= bad_torques) finding.add(Action::retract, Cause::torque_not_finite);
  const bool usable =
      static_cast<std::size_t>(proposal.zone) < zones &&
      (proposal.zone != Zone::bench || options_.bench) &&
      static_cast<std::size_t>(proposal.phase) <= 3 && is_unit(proposal.normal_in_base) &&
      proposal.virtual_target_in_base.allFinite() && std::isfinite(proposal.stiffness_n_per_m) &&
      proposal.stiffness_n_per_m >= 0.0;
  if (!usable) {
    finding.add(Action::retract, Cause::bad_proposal);
    return;
  }
  // The force that the springs can build up against a person who rises, whatever the sensor says.
  const ForceLimits limits = limits_of(seen, proposal);
  const Vector3 leash_m = proposal.virtual_target_in_base - seen.tool_in_base;
  const double pull_n = -leash_m.dot(normal_in_base_) * proposal.stiffness_n_per_m;
  if (proposal.phase == Phase::contact && pull_n > limits.trip_n) {
    finding.add(Action::retract, Cause::leash_too_long);
  }
  if (!(proposal.set_force_n <= limits.set_n)) {
    finding.add(Action::retract, Cause::set_force_too_high);
  }
}

}  // namespace tuina::safety
