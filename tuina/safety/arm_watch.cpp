// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/arm_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::safety {
namespace {

constexpr double averaged_ticks = 100.0;
// Zeros may be off by 3 N and drift by 1 N a minute, twice what sensors do. Time is counted in
// ticks, so that no proposal can hurry it.
constexpr double max_zero_n = 3.0, max_drift_n_per_s = 1.0 / 60.0;
constexpr double first_look_s = 0.05;
constexpr double at_stop_rad = 0.02;

// Torque of a joint that may stay unexplained: its friction, which is known to a fifth, times this;
// and a share of the drive's limit, since masses are known to a tenth. The share is larger where a
// hand leads the arm, with up to 30 N.
constexpr double friction_share = 1.5;
constexpr double drive_share = 0.04, led_share = 0.1;

// Speed that coarse encoders may feign: a joint at rest shows up to a fifth of it.
constexpr double unexplained_rad_per_s = 0.05;
// Part of a millisecond within which nobody can time when a drive takes over a new torque.
constexpr double untimed_s = 0.25e-3;
// Speeds and samples of the wrist are filtered and tell of a torque that much later.
constexpr double lag_s = 2e-3;
// A change of torque comes late to the arm. A gear that winds up, with 40 Hz at the least, lets the
// motor, where the encoder is, run ahead of the joint: in the direction of the change more momentum
// is seen than there is, by as much as the motor is lighter than what it moves.
constexpr double late_s = 1e-3, winding_s = 4e-3, max_ahead_s = 16e-3;
// What a gear swings to and fro comes back; a hand or a fault takes momentum one way. The swing
// that was seen may be the half of the next.
constexpr double swings_share = 2.0;
// A wild sample of the wrist may change what is known of it by this much in a millisecond.
constexpr double wild_n = 10.0, wild_nm = 1.0;
constexpr double max_gap_ticks = 10.0;
// Factor by which the misfit of one joint must exceed that of every other to blame its drive.
constexpr double alone = 2.0;

// Step of the wrist sensor itself, such as a zero that jumps: a change of at least `min_step_n`
// between calm ones, each below `calm_share` of it. No force looks so: behind a filter of up to
// 250 Hz the second change after a sudden force is still a fifth of the first.
constexpr double min_step_n = 2.5, calm_share = 0.2;
constexpr std::size_t calm_before = 2;    // of the changes that are kept; the others come after it
constexpr double max_sampled_s = 1.5e-3;  // between samples; farther apart a force may look so, too

}  // namespace

// mass * ddq + coriolis + gravity = motor - friction + J^T wrench, over one millisecond.
void ArmWatch::compare(const robot::ArmDynamics& dynamics, const robot::ArmReading& reading,
                       const Vector3& force_in_base_n, const JointVector& applied_nm,
                       double passed_s, double share) noexcept {
  const bool begins = dq_rad_per_s_.size() == 0;
  robot::Vector6 wrench;
  wrench << force_in_base_n, dynamics.base_from_tool.linear() * reading.wrench_in_tool.torque_nm;
  const bool felt = wrench.allFinite();
  if (begins && felt) wrench_ = wrench;
  robot::Vector6 wild;
  wild << Vector3::Constant(wild_n), Vector3::Constant(wild_nm);
  if (felt) wrench_ += (wrench - wrench_).cwiseMin(wild).cwiseMax(-wild);
  const JointVector gained =
      begins ? JointVector::Zero(reading.q_rad.size())
             : JointVector(dynamics.mass_kg_m2 * (reading.dq_rad_per_s - dq_rad_per_s_));
  dq_rad_per_s_ = reading.dq_rad_per_s;
  if (applied_nm.size() != reading.q_rad.size()) return;
  if (lagged_nm_.size() == 0) {
    lagged_nm_ = applied_nm;
    missing_ahead_ = missing_back_ = JointVector::Zero(applied_nm.size());
  }
  const JointVector change_nm =
      control_period_s / (control_period_s + lag_s) * (applied_nm - lagged_nm_);
  lagged_nm_ += change_nm;
  const JointVector driven_nm = lagged_nm_ - dynamics.coriolis_nm - dynamics.gravity_nm +
                                dynamics.jacobian.transpose() * wrench_;
  const JointVector missing = passed_s * driven_nm - gained;
  if (passed_s > 0.0) unexplained_nm_ = missing / passed_s;
  for (Eigen::Index i = 0; i < missing.size(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const robot::Link& link = model_.table().links[joint];
    torques_nm_[joint].add(change_nm[i]);
    unexplained_nms_[joint].add(missing[i]);
    const double friction_nm =
        link.coulomb_nm + link.viscous_nm_s_per_rad * std::abs(reading.dq_rad_per_s[i]);
    const double allowed = passed_s * (friction_share * friction_nm + share * link.torque_limit_nm);
    missing_ahead_[i] = std::max(0.0, missing_ahead_[i] + missing[i] - allowed);
    missing_back_[i] = std::max(0.0, missing_back_[i] - missing[i] - allowed);
    // A joint that leans against its stop is held by that, and by nothing that is known here.
    const double q_rad = reading.q_rad[i];
    if (q_rad < link.min_rad + at_stop_rad || q_rad > link.max_rad - at_stop_rad)
      missing_ahead_[i] = missing_back_[i] = 0.0;
  }
  weigh(dynamics);
}

// A drive that gives less than it is told leaves its own joint alone short of momentum, in the
// direction of its torque; a hand on the arm leaves several joints so, in any.
void ArmWatch::weigh(const robot::ArmDynamics& dynamics) noexcept {
  Eigen::Index worst = 0;
  const JointVector torque_limits_nm = model_.table().torque_limits_nm();
  JointVector shares(missing_ahead_.size());
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const Swing::Extent torque_nm = torques_nm_[joint].extent();
    const double borne_nms = unexplained_rad_per_s * dynamics.mass_kg_m2(i, i) +
                             untimed_s * torque_limits_nm[i] +
                             swings_share * unexplained_nms_[joint].extent().to_and_fro() +
                             late_s * std::max(torque_nm.raised, torque_nm.lowered);
    const double rotors =
        dynamics.mass_kg_m2(i, i) / model_.table().links[joint].rotor_inertia_kg_m2;
    const double ahead_s = std::min(winding_s * (rotors - 1.0), max_ahead_s);
    shares[i] = std::max(missing_ahead_[i] / (borne_nms + ahead_s * torque_nm.lowered),
                         missing_back_[i] / (borne_nms + ahead_s * torque_nm.raised));
  }
  misfit_ = shares.maxCoeff(&worst);
  JointVector others = shares;
  others[worst] = 0.0;
  const double missing = lagged_nm_[worst] > 0.0 ? missing_ahead_[worst] : missing_back_[worst];
  const bool of_drive = missing > 0.0 && shares[worst] > alone * others.maxCoeff();
  weak_joint_ = of_drive ? static_cast<int>(worst) : -1;
}

// One or two wild samples come and go, a blow swings back, a body goes on: what was calm for two
// samples before must be so for four after.
bool ArmWatch::steps(const robot::ArmReading& reading) noexcept {
  if (reading.wrench_time_s == sample_time_s_) return false;
  std::rotate(changes_n_.begin(), changes_n_.begin() + 1, changes_n_.end());
  changes_n_.back() = (reading.wrench_in_tool.force_n - sample_.force_n).norm();
  if (!(reading.wrench_time_s - sample_time_s_ < max_sampled_s)) changes_n_.fill(0.0);
  const double step_n = changes_n_[calm_before];
  const auto calm = [&](double change_n) { return change_n < calm_share * step_n; };
  return step_n > min_step_n &&
         std::all_of(changes_n_.begin(), changes_n_.begin() + calm_before, calm) &&
         std::all_of(changes_n_.begin() + calm_before + 1, changes_n_.end(), calm);
}

// No living sensor says the same twice to the last bit: its noise is finer than that.
void ArmWatch::count_repeats(const robot::ArmReading& reading) noexcept {
  if (reading.wrench_time_s == sample_time_s_) return;
  const Wrench& now = reading.wrench_in_tool;
  const bool same = now.force_n == sample_.force_n && now.torque_nm == sample_.torque_nm;
  repeats_ = same ? repeats_ + 1 : 0;
  sample_ = now;
  sample_time_s_ = reading.wrench_time_s;
}

// In the air nothing but the tool is felt: at the first look, and whenever an approach begins.
void ArmWatch::zero(Phase phase) noexcept {
  const bool approaches = phase == Phase::approach && phase_ != Phase::approach;
  const bool looks = !looked_ && phase == Phase::free && watched_s_ > first_look_s;
  if (looks || approaches) {
    looked_ = true;
    zero_jump_n_ =
        (mean_in_tool_n_ - zero_in_tool_n_).norm() - max_drift_n_per_s * (watched_s_ - zeroed_s_);
  }
  if (!approaches) return;
  zeroed_s_ = watched_s_;
  const double max_n = max_zero_n + max_drift_n_per_s * watched_s_;
  zero_in_tool_n_ = mean_in_tool_n_ * (max_n / std::max(mean_in_tool_n_.norm(), max_n));
}

Observation ArmWatch::observe(const robot::RobotReading& reading, Arm arm, const Proposal& proposal,
                              const JointVector& applied_nm) noexcept {
  const Phase phase = proposal.phase;
  const robot::ArmReading& raw = reading.arms[arm];
  Observation seen{.tick = reading.tick,
                   .time_s = reading.time_s,
                   .wrench_time_s = raw.wrench_time_s,
                   .q_rad = raw.q_rad,
                   .dq_rad_per_s = raw.dq_rad_per_s};
  if (raw.q_rad.size() != model_.joints() || raw.dq_rad_per_s.size() != model_.joints())
    return seen;  // the guard brakes an arm that it does not know
  const double ticks = static_cast<double>(reading.tick - tick_);  // very many, backwards
  tick_ = reading.tick;
  const robot::ArmDynamics dynamics = model_.evaluate(raw.q_rad, raw.dq_rad_per_s, reading.rail_m);
  const Matrix3 base_from_tool = dynamics.base_from_tool.linear();
  const Vector3 weight_n(0.0, 0.0, -model_.table().tool_mass_kg * gravity_m_per_s2);
  Vector3 felt_in_tool_n = raw.wrench_in_tool.force_n - base_from_tool.transpose() * weight_n;
  if (!raw.wrench_in_tool.torque_nm.allFinite())
    felt_in_tool_n.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (felt_in_tool_n.allFinite()) {
    if (!started_) mean_in_tool_n_ = felt_in_tool_n;
    started_ = true;
    mean_in_tool_n_ += (felt_in_tool_n - mean_in_tool_n_) / averaged_ticks;
  }
  watched_s_ += control_period_s * std::min(ticks, max_gap_ticks);
  zero(phase);
  phase_ = phase;
  seen.force_in_base_n = base_from_tool * (felt_in_tool_n - zero_in_tool_n_);
  seen.tool_in_base = dynamics.base_from_tool.translation();
  seen.tip_in_base = seen.tool_in_base + model_.table().tool_radius_m * base_from_tool.col(0);
  seen.jacobian = dynamics.jacobian.topRows<3>();
  seen.tool_velocity_m_per_s = seen.jacobian * raw.dq_rad_per_s;
  seen.mass_kg_m2 = dynamics.mass_kg_m2;
  seen.gravity_nm = dynamics.gravity_nm;
  compare(dynamics, raw, seen.force_in_base_n, applied_nm,
          control_period_s * std::min(ticks, max_gap_ticks),
          proposal.stiffness_n_per_m == 0.0 ? led_share : drive_share);
  seen.torque_misfit = misfit_;
  seen.weak_joint = weak_joint_;
  seen.unexplained_nm = unexplained_nm_;
  if (ticks > 0.0) drives_.compare(raw.measured_torque_nm, applied_nm, ticks > 1.0);
  seen.drive_misfit = drives_.misfit();
  seen.reversed_joint = drives_.reversed_joint();
  seen.wrist_stepped = steps(raw);
  count_repeats(raw);
  seen.wrist_repeats = repeats_;
  seen.zero_jump_n = zero_jump_n_;
  return seen;
}

}  // namespace tuina::safety
