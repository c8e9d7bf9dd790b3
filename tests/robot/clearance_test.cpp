// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/clearance.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tuina/core/random.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

using namespace tuina;
using namespace tuina::robot;

TEST_CASE("the distance of two arms is that of their closest sampled points") {
  const RobotMount mount = mount_for(Position::sitting);
  const ArmModel left(thesis_arm(), mount, Arm::left), right(thesis_arm(), mount, Arm::right);
  Random random = make_random(3, "clearance");
  for (int trial = 0; trial < 200; ++trial) {
    JointVector a(6), b(6);
    for (int i = 0; i < 6; ++i)
      a[i] = uniform(random, -2.0, 2.0), b[i] = uniform(random, -2.0, 2.0);
    const auto one = left.kinematics(a, 0.0), other = right.kinematics(b, 0.1);
    double sampled_m = 1e9;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        const double radii_m = left.table().links[i].radius_m + right.table().links[j].radius_m;
        for (int u20 = 0; u20 <= 20; ++u20) {
          for (int v20 = 0; v20 <= 20; ++v20) {
            const double u = u20 / 20.0, v = v20 / 20.0;
            const Vector3 p = (1 - u) * one.origins_in_base[i] + u * one.origins_in_base[i + 1];
            const Vector3 q = (1 - v) * other.origins_in_base[j] + v * other.origins_in_base[j + 1];
            sampled_m = std::min(sampled_m, (p - q).norm() - radii_m);
          }
        }
      }
    }
    const double distance_m = distance_between_m(left, one, right, other);
    CHECK(distance_m <= sampled_m + 1e-9);
    CHECK(distance_m > sampled_m - 0.012);
  }
}

TEST_CASE("two arms that wait before a person are far from each other") {
  const RobotMount mount = mount_for(Position::sitting);
  const ArmModel left(thesis_arm(), mount, Arm::left), right(thesis_arm(), mount, Arm::right);
  const auto ready = ready_posture(thesis_arm(), mount);
  CHECK(distance_between_m(left, left.kinematics(ready[Arm::left], 0.0), right,
                           right.kinematics(ready[Arm::right], 0.0)) > 0.06);
}
