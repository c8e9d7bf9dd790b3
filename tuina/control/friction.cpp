// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/friction.hpp"

#include <algorithm>

namespace tuina::control {

FrictionCompensation::FrictionCompensation(const robot::ArmTable& table,
                                           const Options& options) noexcept
    : table_(table), options_(options), coulomb_nm_(table.joints) {
  for (int i = 0; i < table.joints; ++i) {
    coulomb_nm_[i] = options.share_of_table * table.links[static_cast<std::size_t>(i)].coulomb_nm;
  }
  start(JointVector::Zero(table.joints));
}

void FrictionCompensation::start(const JointVector& q_rad) noexcept {
  q_rad_ = q_rad;
  wound_ = JointVector::Zero(q_rad.size());
}

JointVector FrictionCompensation::step(const JointVector& q_rad) noexcept {
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double turned = (q_rad[i] - q_rad_[i]) / options_.windup_rad;
    const double direction = turned > 0.0 ? 1.0 : -1.0;
    wound_[i] = std::clamp(wound_[i] + turned * (1.0 - wound_[i] * direction), -1.0, 1.0);
  }
  q_rad_ = q_rad;
  return learning_ ? JointVector(JointVector::Zero(q_rad.size()))
                   : JointVector(coulomb_nm_.cwiseProduct(wound_));
}

void FrictionCompensation::begin_learning() noexcept {
  sums_ = {};
  learning_ = true;
}

void FrictionCompensation::learn(const JointVector& rest_nm,
                                 const JointVector& dq_rad_per_s) noexcept {
  for (Eigen::Index i = 0; i < rest_nm.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double rest = rest_nm[i] - table_.links[k].viscous_nm_s_per_rad * dq_rad_per_s[i];
    Sums& sums = sums_[k];
    sums.n += 1.0;
    sums.w += wound_[i];
    sums.ww += wound_[i] * wound_[i];
    sums.r += rest;
    sums.wr += wound_[i] * rest;
  }
}

// Least squares of residual = friction x wound + gravity error; a joint that hardly turned is
// skipped.
void FrictionCompensation::end_learning() noexcept {
  learning_ = false;
  for (Eigen::Index i = 0; i < coulomb_nm_.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Sums& sums = sums_[k];
    const double spread = sums.n * sums.ww - sums.w * sums.w;
    if (!(spread > 0.1 * sums.n * sums.n)) continue;
    const double friction_nm = (sums.n * sums.wr - sums.w * sums.r) / spread;
    const double max_nm = 4.0 * table_.links[k].coulomb_nm;
    coulomb_nm_[i] = options_.share * std::clamp(friction_nm, 0.0, max_nm);
  }
}

}  // namespace tuina::control
