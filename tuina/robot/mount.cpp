// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/mount.hpp"

namespace tuina::robot {

namespace {

Obstacle part_of_body(const Vector3& middle_in_base, const Vector3& edges_m, bool rides) {
  Obstacle part{.kind = Surrounding::body, .edges_m = edges_m, .rides = rides};
  part.base_from_box.translation() = middle_in_base;
  return part;
}

}  // namespace

Obstacle couch_of(Position position, const Transform& base_from_couch) {
  constexpr double thick_m = 80_mm;
  const bool sits = position == Position::sitting;
  Obstacle couch{.edges_m =
                     sits ? Vector3(500_mm, 500_mm, thick_m) : Vector3(760_mm, 2000_mm, thick_m)};
  couch.base_from_box =
      base_from_couch * Eigen::Translation3d(0.0, sits ? -20_mm : 0_mm, -0.5 * thick_m);
  return couch;
}

RobotMount mount_for(Position position) {
  constexpr double between_shoulders_m = 330_mm;
  RobotMount mount;

  // base x is couch minus y, base y is couch x: the left arm faces the person's left in both
  // positions.
  Matrix3 base_from_couch_turn;
  base_from_couch_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;

  // Upright, the upper arms hang down at q = 0 and the forearms point ahead.
  Matrix3 upright;  // columns: x0 down, y0 ahead, z0 to the right
  upright << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  Matrix3 shoulder_turn = upright;
  Vector3 midway_in_couch;
  if (position == Position::sitting) {
    midway_in_couch = Vector3(0.0, 450_mm, 430_mm);
    mount.min_rail_m = -300_mm;
    mount.max_rail_m = 350_mm;
  } else {
    midway_in_couch = Vector3(0.0, 0.0, 660_mm);
    shoulder_turn = Eigen::AngleAxisd(90_deg, Vector3::UnitY()) * upright;  // ahead becomes down
    mount.min_rail_m = -600_mm;
    mount.max_rail_m = 600_mm;
  }
  mount.base_from_couch.linear() = base_from_couch_turn;
  mount.base_from_couch.translation() = -base_from_couch_turn * midway_in_couch;
  mount.base_from_couch.makeAffine();
  mount.obstacles.push_back(couch_of(position, mount.base_from_couch));
  // A carriage carries the shoulders: on a column that stands on two rails, or under the two of a
  // gantry, between which the scanner looks.
  const double length_m = mount.max_rail_m - mount.min_rail_m + 200_mm;
  const double middle_m = 0.5 * (mount.max_rail_m + mount.min_rail_m);
  if (position == Position::sitting) {
    mount.obstacles.push_back(part_of_body({-50_mm, 0.0, 0.0}, {70_mm, 400_mm, 160_mm}, true));
    mount.obstacles.push_back(part_of_body({-90_mm, 0.0, -300_mm}, {90_mm, 160_mm, 500_mm}, true));
    for (const double side_m : {-150_mm, 150_mm}) {
      mount.obstacles.push_back(
          part_of_body({middle_m - 50_mm, side_m, -560_mm}, {length_m, 40_mm, 40_mm}, false));
    }
  } else {
    mount.obstacles.push_back(part_of_body({0.0, 0.0, 50_mm}, {160_mm, 400_mm, 70_mm}, true));
    for (const double side_m : {-150_mm, 150_mm}) {
      mount.obstacles.push_back(
          part_of_body({middle_m, side_m, 110_mm}, {length_m, 40_mm, 40_mm}, false));
    }
  }
  // 0.28 m ahead is 0.15 m off a back at 0.45 m; a little below the shoulders the elbow is well
  // bent.
  mount.ready_from_shoulder = 280_mm * shoulder_turn.col(1) + 60_mm * shoulder_turn.col(0);
  mount.ahead_in_base = shoulder_turn.col(1);
  for (const Arm arm : both_arms) {
    Transform& shoulder = mount.base_from_shoulder[arm];
    shoulder.linear() = shoulder_turn;
    shoulder.translation() =
        Vector3(0.0, (arm == Arm::left ? 0.5 : -0.5) * between_shoulders_m, 0.0);
    shoulder.makeAffine();
  }
  return mount;
}

}  // namespace tuina::robot
