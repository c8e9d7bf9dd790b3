// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/friction.hpp"

#include <algorithm>

namespace tuina::control {

void FrictionCompensation::start(const JointVector& q_rad) noexcept {
  q_rad_ = q_rad;
  wound_ = JointVector::Zero(q_rad.size());
}

JointVector FrictionCompensation::step(const JointVector& q_rad) noexcept {
  JointVector torque_nm(q_rad.size());
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double turned = (q_rad[i] - q_rad_[i]) / windup_rad_;
    const double direction = turned > 0.0 ? 1.0 : -1.0;
    wound_[i] = std::clamp(wound_[i] + turned * (1.0 - wound_[i] * direction), -1.0, 1.0);
    torque_nm[i] = share_ * table_.links[static_cast<std::size_t>(i)].coulomb_nm * wound_[i];
  }
  q_rad_ = q_rad;
  return torque_nm;
}

}  // namespace tuina::control
