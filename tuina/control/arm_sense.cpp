// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/arm_sense.hpp"

namespace tuina::control {
namespace {

constexpr double averaged_ticks = 100.0;
// No contact changes the filtered sensor by this much in a millisecond.
constexpr double wild_n = 25.0;
constexpr int believed_after = 3;

}  // namespace

ArmState ArmSense::sense(const robot::ArmReading& reading, double time_s, double rail_m) noexcept {
  ArmState state{.time_s = time_s,
                 .q_rad = reading.q_rad,
                 .dq_rad_per_s = reading.dq_rad_per_s,
                 .base_from_tool = model_->base_from_tool(reading.q_rad, rail_m),
                 .contact_in_base = {}};
  const Matrix3 base_from_tool = state.base_from_tool.linear();
  const Vector3 weight_n(0.0, 0.0, -model_->table().tool_mass_kg * gravity_m_per_s2);
  const Wrench seen = {reading.wrench_in_tool.force_n - base_from_tool.transpose() * weight_n,
                       reading.wrench_in_tool.torque_nm};

  const bool finite = seen.force_n.allFinite() && seen.torque_nm.allFinite();
  const bool wild =
      started_ && (seen.force_n - last_.force_n).norm() > wild_n && suspects_ < believed_after - 1;
  if (finite && !wild) {
    last_ = seen;
    if (!started_) mean_ = seen;
    started_ = true;
  }
  suspects_ = wild ? suspects_ + 1 : 0;
  mean_.force_n += (last_.force_n - mean_.force_n) / averaged_ticks;
  mean_.torque_nm += (last_.torque_nm - mean_.torque_nm) / averaged_ticks;

  state.contact_in_base = {base_from_tool * (last_.force_n - bias_.force_n),
                           base_from_tool * (last_.torque_nm - bias_.torque_nm)};
  return state;
}

}  // namespace tuina::control
