// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/arm_table.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::robot {

JointVector ArmTable::torque_limits_nm() const noexcept {
  JointVector limits = JointVector::Zero(joints);
  for (int i = 0; i < joints; ++i) limits[i] = links[static_cast<std::size_t>(i)].torque_limit_nm;
  return limits;
}

int elbow_origin(const ArmTable& table) noexcept {
  double length_m = 0.0;
  for (const Link& link : table.links) length_m += std::hypot(link.d_m, link.a_m);
  // Every joint is turned by some angle, so that no two axes are in line by chance.
  std::array<Vector3, max_joints> origins, axes;
  Transform here = Transform::Identity();
  for (int i = 0; i < table.joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Link& link = table.links[k];
    origins[k] = here.translation();
    axes[k] = here.linear().col(2);
    const double some_rad = 0.4 + 0.3 * i;
    here = here * Eigen::AngleAxisd(some_rad + link.offset_rad, Vector3::UnitZ()) *
           Eigen::Translation3d(link.a_m, 0.0, link.d_m) *
           Eigen::AngleAxisd(link.alpha_rad, Vector3::UnitX());
    for (std::size_t j = 0; j <= k; ++j) {
      const Vector3 lever = here.translation() - origins[j];
      if (axes[j].cross(lever).norm() > length_m / 7.0) return i + 1;
    }
  }
  return table.joints;
}

}  // namespace tuina::robot
