// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/virtual_arm.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::robot {
namespace {

// Zero errors of wrist sensors, and a hand that leads the tool gently.
constexpr double max_pull_n = 5.0;

}  // namespace

void VirtualArm::stand(const JointVector& q_rad) noexcept {
  q_rad_ = q_rad;
  dq_rad_per_s_ = JointVector::Zero(q_rad.size());
}

// An arm that feels nothing, or a pull, would press as hard as it can. Torques bound what an arm
// presses with that takes them; with one that takes places only the sensor does.
void VirtualArm::keep_from_pressing(const ArmDynamics& dynamics) noexcept {
  const Vector3 inward = dynamics.base_from_tool.linear().col(0);
  const JointVector lever = dynamics.jacobian.topRows<3>().transpose() * inward;
  const double inward_m_per_s = lever.dot(dq_rad_per_s_);
  if (inward_m_per_s <= 0.0) return;
  const JointVector yields = acceleration(dynamics.mass_kg_m2, lever);
  const double mobility_per_kg = lever.dot(yields);
  if (mobility_per_kg <= 0.0) return stand(q_rad_);
  dq_rad_per_s_ -= inward_m_per_s / mobility_per_kg * yields;
}

// All joints slow down together, so that the tool keeps its way.
void VirtualArm::keep_limits() noexcept {
  double share = 1.0;
  for (Eigen::Index i = 0; i < q_rad_.size(); ++i) {
    const Link& link = model_.table().links[static_cast<std::size_t>(i)];
    const double speed = std::abs(dq_rad_per_s_[i]);
    if (speed > link.speed_limit_rad_per_s)
      share = std::min(share, link.speed_limit_rad_per_s / speed);
  }
  dq_rad_per_s_ *= share;
  for (Eigen::Index i = 0; i < q_rad_.size(); ++i) {
    const Link& link = model_.table().links[static_cast<std::size_t>(i)];
    const double next_rad = q_rad_[i] + control_period_s * dq_rad_per_s_[i];
    q_rad_[i] = std::clamp(next_rad, link.min_rad, link.max_rad);
    if (q_rad_[i] != next_rad) dq_rad_per_s_[i] = 0.0;
  }
}

void VirtualArm::step(const JointVector& torque_nm, const Wrench& wrench_in_tool, bool felt,
                      double rail_m) noexcept {
  if (torque_nm.size() != q_rad_.size() || !torque_nm.allFinite()) return stand(q_rad_);
  const ArmDynamics dynamics = model_.evaluate(q_rad_, dq_rad_per_s_, rail_m);
  JointVector driven_nm = torque_nm - dynamics.coriolis_nm - dynamics.gravity_nm;
  const Matrix3 base_from_tool = dynamics.base_from_tool.linear();
  const Vector3 weight_n(0.0, 0.0, -model_.table().tool_mass_kg * gravity_m_per_s2);
  const Vector3 contact_n = base_from_tool * wrench_in_tool.force_n - weight_n;
  const bool believed = felt && contact_n.dot(base_from_tool.col(0)) < max_pull_n;
  if (believed) {
    Vector6 wrench;
    wrench << contact_n, base_from_tool * wrench_in_tool.torque_nm;
    driven_nm += dynamics.jacobian.transpose() * wrench;
  }
  dq_rad_per_s_ += control_period_s * acceleration(dynamics.mass_kg_m2, driven_nm);
  if (!believed) keep_from_pressing(dynamics);
  if (!dq_rad_per_s_.allFinite()) dq_rad_per_s_.setZero();
  keep_limits();
}

}  // namespace tuina::robot
