// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/clearance.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tuina/core/random.hpp"
#include "tuina/robot/ready_posture.hpp"

using namespace tuina;
using namespace tuina::robot;

TEST_CASE("the distance of two arms is that of their closest sampled points") {
  const RobotMount mount = mount_for(BodyPosture::sitting);
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
  const RobotMount mount = mount_for(BodyPosture::sitting);
  const ArmModel left(thesis_arm(), mount, Arm::left), right(thesis_arm(), mount, Arm::right);
  const auto ready = ready_posture(thesis_arm(), mount);
  CHECK(distance_between_m(left, left.kinematics(ready[Arm::left], 0.0), right,
                           right.kinematics(ready[Arm::right], 0.0)) > 0.06);
}

TEST_CASE("a segment is as far from a box as its closest sampled place") {
  Random random = make_random(4, "boxes");
  const auto draw = [&](double range) {
    return Vector3(uniform(random, -range, range), uniform(random, -range, range),
                   uniform(random, -range, range));
  };
  int touching = 0;
  for (int trial = 0; trial < 2'000; ++trial) {
    Vector3 from = draw(1.0), to = draw(1.0);
    const Vector3 half_m = draw(0.4).cwiseAbs();
    if (trial % 4 == 0) to[trial % 3] = from[trial % 3];  // along a face
    if (trial % 50 == 0) to = from;
    double sampled_m = 1e9;
    constexpr int steps = 400;
    for (int i = 0; i <= steps; ++i) {
      const Vector3 at = from + static_cast<double>(i) / steps * (to - from);
      sampled_m = std::min(sampled_m, (at - at.cwiseMax(-half_m).cwiseMin(half_m)).norm());
    }
    const double distance_m = segment_to_box_m(from, to, half_m);
    REQUIRE(distance_m <= sampled_m + 1e-12);
    REQUIRE(distance_m >= sampled_m - (to - from).norm() / steps - 1e-12);
    touching += distance_m == 0.0 ? 1 : 0;
  }
  CHECK(touching > 100);
}

TEST_CASE("an arm is far from the couch when it waits and in it when it hangs through") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const RobotMount mount = mount_for(position);
    const ArmModel left(thesis_arm(), mount, Arm::left);
    const JointVector ready_rad = ready_posture(thesis_arm(), mount)[Arm::left];
    const Clearances waiting =
        clearances(left, left.kinematics(ready_rad, 0.0), 0.0, mount.obstacles);
    CHECK(waiting[Surrounding::couch] > 0.2);
    CHECK(waiting[Surrounding::body] > 0.06);
    // The couch comes up to the elbow.
    RobotMount raised = mount;
    const auto pose = left.kinematics(ready_rad, 0.0);
    raised.obstacles.front().base_from_box.translation() =
        pose.origins_in_base[static_cast<std::size_t>(elbow_origin(left.table()))];
    CHECK(clearances(left, pose, 0.0, raised.obstacles)[Surrounding::couch] <= -0.05 + 1e-9);
    // What rides goes with the linear base, what does not stays behind.
    const auto away = left.kinematics(ready_rad, 0.2);
    CHECK(clearances(left, away, 0.2, mount.obstacles)[Surrounding::body] > 0.06);
  }
}
