// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/robot/description.hpp"

namespace tuina::robot {

/// What carries the arms: a linear base, or a body on wheels with a waist (`wheeled_body`), whose
/// linear base is the way ahead of its wheels.
enum class Carrier : std::uint8_t { linear_base, wheeled_body };
/// Name of a carrier, as tables of robots have it.
[[nodiscard]] constexpr const char* name_of(Carrier carrier) {
  return carrier == Carrier::linear_base ? "linear_base" : "wheeled_body";
}

/// A solid box of the robot's own body besides the arms, along the axes of `base`.
struct BodyBox {
  Vector3 middle_in_base = Vector3::Zero();
  Vector3 edges_m = Vector3::Zero();
  bool rides = false;  ///< moves with the linear base
  /// Whether the box reaches along x over the whole linear base. Its x edge is then what it is
  /// longer than that, and its x middle counts from the middle of the linear base.
  bool spans_rail = false;
};

/// How a robot is mounted for people in one position. Directions are upright ones: x ahead, y to
/// the left, z up; prone they are all turned about y, so that ahead becomes down.
struct Mounting {
  /// DH frame 0 of each arm.
  PerArm<Matrix3> upright_from_shoulder = {.of = {Matrix3::Identity(), Matrix3::Identity()}};
  double shoulders_apart_m = 330_mm;
  Vector3 midway_in_couch = Vector3::Zero();  ///< place between the shoulders, rail at zero
  double min_rail_m = 0.0, max_rail_m = 0.0;
  Vector3 ready_from_shoulder = Vector3::Zero();  ///< upright: left tool before and after
  double ready_elbow_outward_m = 420_mm;
  JointVector ready_near_rad = {};  ///< where the search for that posture begins; empty: at zero
  std::vector<BodyBox> body = {};

  // What the wheeled body wants instead of `midway_in_couch`.
  double couch_height_m = 0.0;   ///< over the floor
  double waist_pitch_rad = 0.0;  ///< bent forward by so much
  double behind_person_m = 0.0;  ///< sitting: from the couch's origin to the shoulders
};

/// A robot as its table describes it.
struct RobotModel {
  std::string name;
  std::string about;  ///< one sentence for people
  Carrier carrier = Carrier::linear_base;
  ArmTable arm;
  std::array<Mounting, 2> mountings;  ///< indexed by position
  /// Where the robot stands for a person in this position.
  [[nodiscard]] const Mounting& mounting(BodyPosture position) const {
    return mountings[static_cast<std::size_t>(position)];
  }
};

/// A shipped robot by its name, or a robot's table by its path. Everything wrong is in the one
/// message, a line each with file, line, key, value and limit.
[[nodiscard]] Result<RobotModel> load_robot(std::string_view name_or_file);

/// The robots that are built in, from models/robots.
struct ShippedRobot {
  std::string_view name;
  std::string_view toml;
};
/// All robots that are built in.
[[nodiscard]] std::span<const ShippedRobot> shipped_robots();

/// A robot as it stands for a person.
struct RobotPlacement {
  Carrier carrier = Carrier::linear_base;
  ArmTable arm;
  RobotMount mount;
  double waist_pitch_rad = 0.0;              ///< wheeled body only
  PerArm<Matrix3> torso_from_shoulder = {};  ///< wheeled body only: turns of DH frames 0
};

/// On a linear base the robot stands behind a sitting person or hangs over the bed, as its table
/// says. On wheels it bends over its waist: sitting, it stands behind the person; prone, before the
/// head, its base under the bed. In all the left arm is the one on the side of the couch's positive
/// x.
[[nodiscard]] RobotPlacement place_robot(const RobotModel& model, BodyPosture position,
                                         bool head_at_plus_y = false);

/// The seat of the chair, or the bed, in `base`.
[[nodiscard]] Obstacle couch_of(BodyPosture position, const Transform& base_from_couch);

/// The whole of it in `base` with what it stands around, and where its joints are: those of the
/// arms at zero, those of the rest held there by their drives.
struct WholeRobot {
  Description description;
  std::vector<double> q;
  std::string rail;  ///< the part that is the linear base
};
/// The whole robot with two arms as it stands for a person.
[[nodiscard]] WholeRobot whole_of(const RobotPlacement& placement, const PerArm<ArmTable>& arms);

}  // namespace tuina::robot
