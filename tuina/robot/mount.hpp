// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/obstacle.hpp"

namespace tuina::robot {

/// Where the robot stands. `base` has its origin midway between the shoulders when the linear base
/// is at zero; z up, y to the person's left, x = y cross z: sitting, from the robot to the person;
/// prone, from feet to head. Everything on the robot moves along `rail_axis_in_base` with the
/// linear base.
struct RobotMount {
  Transform base_from_couch = Transform::Identity();
  /// DH frame 0 of each arm, rail at zero.
  PerArm<Transform> base_from_shoulder = {.of = {Transform::Identity(), Transform::Identity()}};
  Vector3 rail_axis_in_base = Vector3::UnitX();
  double min_rail_m = 0.0;
  double max_rail_m = 0.0;
  /// Place of the left tool before and after a massage, from the left shoulder; the right is its
  /// mirror image.
  Vector3 ready_from_shoulder = Vector3::Zero();
  double ready_elbow_outward_m = 420_mm;     ///< distance from the middle between the shoulders
  JointVector ready_near_rad = {};           ///< where its search begins; empty: all at zero
  Vector3 ahead_in_base = Vector3::UnitX();  ///< towards the person
  std::vector<Obstacle> obstacles = {};      ///< chair or bed, and the robot's own body

  /// Frame of an arm's shoulder with the rail there.
  [[nodiscard]] Transform base_from_shoulder_at(Arm arm, double rail_m) const {
    return Eigen::Translation3d(rail_m * rail_axis_in_base) * base_from_shoulder[arm];
  }
};

/// How the shipped robot `thesis` is mounted, for what judges it by name.
[[nodiscard]] RobotMount mount_for(BodyPosture position);

}  // namespace tuina::robot
