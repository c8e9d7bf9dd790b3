// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/result.hpp"
#include "tuina/motion/free_path.hpp"
#include "tuina/motion/rollout.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/clearance.hpp"

namespace tuina::motion {

/// Scene shared by the moves of both arms.
struct Stage {
  std::reference_wrapper<const body::BackSurface> back;
  std::reference_wrapper<const PerArm<robot::ArmModel>> models;
  Transform base_from_couch = Transform::Identity();
  double rail_m = 0.0;
  double standoff_m = 40e-3;
  PerArm<JointVector> ready_rad;
  std::span<const robot::Obstacle> obstacles = {};
};

/// Preferred distance to the other arm, the couch and the robot's body.
inline constexpr double wanted_arm_distance_m = 60e-3;
inline constexpr double closest_arm_distance_m = 45e-3;  ///< minimum distance of every planned move

/// An arm at rest between two contacts.
struct ArmRest {
  ApproachPose over;
  JointVector q_rad;
  bool parked = true;
  JointPath stay;  ///< configurations the arm may settle in
  /// Configurations in which posture springs that pull no harder than the controller's leave it:
  /// with a slow nullspace and with a quick one.
  std::array<JointVector, 2> weak_springs_rad;
};
/// The arm where it waits before the first contact and after the last.
[[nodiscard]] ArmRest rest_at_ready(const Stage& stage, Arm arm);

/// One transfer and, unless the arm parks, one contact at its end.
struct ArmMove {
  int path = -1;
  std::vector<control::ToolPose> waypoints_in_base;
  JointVector posture_rad;
  JointPath transfer;
  JointPath contact;  ///< from the approach pose down, along the path, and up again
  double transfer_s = 0.0;
  double stray_m = 0.0;     ///< cost of coming to stand elsewhere than rehearsed, 0 if it does not
  double mass_kg = 0.0;     ///< largest apparent mass along the tool's axis over the contact
  robot::Clearances clear;  ///< distances from couch and robot body over the whole move
  ArmRest above;            ///< at rest after the transfer, before the contact
  ArmRest after;
};

/// Plans the move from a rest back to where the arm waits.
[[nodiscard]] ArmMove move_home(const Stage& stage, Arm arm, const ArmRest& from);

/// True when the arm does not get stuck on its way, nor come too near to the couch or the robot's
/// body.
[[nodiscard]] bool gets_there(const ArmMove& move);
/// True when the arm comes to its home configuration, not only to the home pose: with the wrist
/// flipped the posture springs would swing it round.
[[nodiscard]] bool comes_home(const Stage& stage, Arm arm, const ArmMove& home);

/// Plans a move of the tool by `by_in_couch` in the posture that the arm has, which keeps its elbow
/// from coming nearer to the other arm.
[[nodiscard]] ArmMove move_aside(const Stage& stage, Arm arm, const ArmRest& from,
                                 const Vector3& by_in_couch);

/// Plans the move to a path: of the configurations that follow the path, the cheapest that the
/// transfer really ends in. Fails when no configuration follows the path.
[[nodiscard]] Result<ArmMove> move_to_path(const Stage& stage, Arm arm, const ArmRest& from,
                                           const ContactPath& path, int index);

/// Points of a path in base, at least 1 mm apart.
[[nodiscard]] std::vector<robot::ContactGoal> goals_of(const ContactPath& path,
                                                       const Transform& base_from_couch);

}  // namespace tuina::motion
