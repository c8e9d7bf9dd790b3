// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/mount.hpp"

namespace tuina::robot {

RobotMount mount_for(Position position) noexcept {
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
    mount.lowest_rail_m = -300_mm;
    mount.highest_rail_m = 350_mm;
  } else {
    midway_in_couch = Vector3(0.0, 0.0, 660_mm);
    shoulder_turn = Eigen::AngleAxisd(90_deg, Vector3::UnitY()) * upright;  // ahead becomes down
    mount.lowest_rail_m = -600_mm;
    mount.highest_rail_m = 600_mm;
  }
  mount.base_from_couch.linear() = base_from_couch_turn;
  mount.base_from_couch.translation() = -base_from_couch_turn * midway_in_couch;
  mount.base_from_couch.makeAffine();
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
