// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/arm_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::safety {
namespace {

constexpr double averaged_ticks = 100.0;
constexpr double max_zero_n = 3.0;
constexpr double at_stop_rad = 0.02;

// Friction is known to a fifth, masses to a tenth; a hand may lead an arm with 30 N.
constexpr double friction_share = 1.5;
constexpr double drive_share = 0.04, led_share = 0.1;

}  // namespace

// Torque that neither the model, nor what the wrist sensor feels, nor friction explains, as a share
// of what a sound arm may leave unexplained: mass * ddq + coriolis + gravity = motor - friction +
// J^T wrench, averaged over the window, the acceleration being the change of speed in it.
void ArmWatch::compare(const robot::ArmDynamics& dynamics, const robot::ArmReading& reading,
                       const Vector3& force_in_base_n, const JointVector& applied_nm,
                       double share) noexcept {
  if (applied_nm.size() != reading.q_rad.size() || !force_in_base_n.allFinite()) return;
  const Matrix3 base_from_tool = dynamics.base_from_tool.linear();
  robot::Vector6 wrench;
  wrench << force_in_base_n, base_from_tool * reading.wrench_in_tool.torque_nm;
  const JointVector unexplained_nm = applied_nm - dynamics.coriolis_nm - dynamics.gravity_nm +
                                     dynamics.jacobian.transpose() * wrench;
  const JointVector before = speeds_[next_];
  speeds_[next_] = reading.dq_rad_per_s;
  unexplained_nm_[next_] = unexplained_nm;
  next_ = (next_ + 1) % window;
  filled_ = std::min(filled_ + 1, window + 1);
  if (filled_ <= window) return;
  JointVector mean_nm = JointVector::Zero(reading.q_rad.size());
  for (const JointVector& one_nm : unexplained_nm_) mean_nm += one_nm / double{window};
  const JointVector acceleration =
      (reading.dq_rad_per_s - before) / (double{window} * control_period_s);
  mean_nm -= dynamics.mass_kg_m2 * acceleration;
  misfit_ = 0.0;
  for (Eigen::Index i = 0; i < mean_nm.size(); ++i) {
    const robot::Link& link = model_.table().links[static_cast<std::size_t>(i)];
    // A joint that leans against its stop is held by that, and by nothing that is known here.
    const double q_rad = reading.q_rad[i];
    if (q_rad < link.min_rad + at_stop_rad || q_rad > link.max_rad - at_stop_rad) continue;
    const double friction_nm =
        link.coulomb_nm + link.viscous_nm_s_per_rad * std::abs(reading.dq_rad_per_s[i]);
    const double allowed_nm = friction_share * friction_nm + share * link.torque_limit_nm;
    misfit_ = std::max(misfit_, std::abs(mean_nm[i]) / allowed_nm);
  }
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
  if (phase == Phase::approach && phase_ != Phase::approach)
    zero_in_tool_n_ = mean_in_tool_n_ * (max_zero_n / std::max(mean_in_tool_n_.norm(), max_zero_n));
  phase_ = phase;
  seen.force_in_base_n = base_from_tool * (felt_in_tool_n - zero_in_tool_n_);
  seen.tool_in_base = dynamics.base_from_tool.translation();
  seen.tip_in_base = seen.tool_in_base + model_.table().tool_radius_m * base_from_tool.col(0);
  seen.jacobian = dynamics.jacobian.topRows<3>();
  seen.tool_velocity_m_per_s = seen.jacobian * raw.dq_rad_per_s;
  seen.mass_kg_m2 = dynamics.mass_kg_m2;
  seen.gravity_nm = dynamics.gravity_nm;
  compare(dynamics, raw, seen.force_in_base_n, applied_nm,
          proposal.stiffness_n_per_m == 0.0 ? led_share : drive_share);
  seen.torque_misfit = misfit_;
  return seen;
}

}  // namespace tuina::safety
