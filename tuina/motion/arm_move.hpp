// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/result.hpp"
#include "tuina/motion/free_path.hpp"
#include "tuina/motion/rollout.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/clearance.hpp"

namespace tuina::motion {

/// What the moves of both arms have in common.
struct Stage {
  std::reference_wrapper<const body::BackSurface> back;
  std::reference_wrapper<const PerArm<robot::ArmModel>> models;
  Transform base_from_couch = Transform::Identity();
  double rail_m = 0.0;
  double standoff_m = 40e-3;
  PerArm<JointVector> ready_rad;
  std::span<const robot::Obstacle> obstacles = {};
};

inline constexpr double wanted_arm_distance_m = 60e-3;   ///< to the other arm, couch and own body
inline constexpr double closest_arm_distance_m = 45e-3;  ///< nothing is planned below this

/// Where an arm is between two contacts.
struct ArmRest {
  Hover over;
  JointVector q_rad;
  bool parked = true;
  Passage stay;  ///< the postures that it may be in
};
[[nodiscard]] ArmRest rest_at_ready(const Stage& stage, Arm arm);

/// One way through the air and, unless the arm parks, one contact at its end.
struct ArmMove {
  int path = -1;
  std::vector<control::ToolPose> way_in_base;
  JointVector posture_rad;
  Passage air, skin;  ///< skin: from above the place down, along the path, and up again
  double air_s = 0.0;
  robot::Clearances clear;  ///< from couch and own body, all the way
  ArmRest above;            ///< after the way, before the contact
  ArmRest after;
};

[[nodiscard]] ArmMove move_home(const Stage& stage, Arm arm, const ArmRest& from);

/// Of the postures that the path can be followed in, one that the way really leads to and that
/// keeps the arm on its own side, if there is such a one. Fails when no posture follows the path.
[[nodiscard]] Result<ArmMove> move_to_path(const Stage& stage, Arm arm, const ArmRest& from,
                                           const ContactPath& path, int index);

/// Places of a path, each no nearer than a millimetre to the one before.
[[nodiscard]] std::vector<robot::ContactGoal> goals_of(const ContactPath& path,
                                                       const Transform& base_from_couch);

}  // namespace tuina::motion
