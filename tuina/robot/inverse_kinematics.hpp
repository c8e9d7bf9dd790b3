// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/arm_model.hpp"

namespace tuina::robot {

/// A place on the skin for the sphere to touch. The tool may turn about its own axis as it likes.
struct ContactGoal {
  Vector3 at_in_base = Vector3::Zero();
  Vector3 normal_in_base = Vector3::UnitZ();  ///< unit, out of the body
};

/// Why a goal is out of reach.
enum class Reach : std::uint8_t { reached, too_far, joint_limits, elbow_in_person };
/// Says in words why a pose is not reached.
[[nodiscard]] const char* explain(Reach reach) noexcept;

/// Joint angles that touch a goal, or how near they come and why no nearer.
struct ContactPosture {
  JointVector q_rad;
  Reach reach = Reach::too_far;
  double limit_room_rad = 0.0;  ///< room at the joint that is closest to its end
  double tilt_rad = 0.0;        ///< angle of the tool's axis away from the normal
  double dexterity = 0.0;       ///< m/rad
};

/// What a posture has to keep to.
struct PostureOptions {
  double max_tilt_rad = 20_deg;
  double limit_margin_rad = 3_deg;   ///< room kept at the end of every joint
  double elbow_clearance_m = 80_mm;  ///< height of the elbow above the tangent plane of the skin
  /// The elbow is drawn outward, away from the other arm, until it is so far from the middle
  /// between the shoulders; softly, the task comes first. Zero: not at all.
  double elbow_outward_m = 0.0;
  double press_depth_m = 0.0;  ///< the sphere's foremost point is so deep in the skin
};

/// Smallest singular value of the Jacobian of the tool's tip and axis, 0.3 m to the radian of the
/// axis, m/rad: where it is small, a small way of the tool needs a large one of the joints.
[[nodiscard]] double dexterity(const ArmModel::Kinematics& pose) noexcept;

/// From the joint that is closest to its end.
[[nodiscard]] double limit_room_rad(const ArmTable& table, const JointVector& q_rad) noexcept;

/// Joint angles that put the sphere on the skin with the tool's axis against the normal, or tilted
/// as little as needed. Damped least squares from `near_rad`, then from seeds spread over the
/// joints' ranges; the joint that the task leaves free keeps off the limits and the elbow off the
/// person. No heap; at worst 10 ms.
[[nodiscard]] ContactPosture find_posture(const ArmModel& arm, double rail_m,
                                          const ContactGoal& goal, const JointVector& near_rad,
                                          const PostureOptions& options = {}) noexcept;

/// Postures along a path without a jump. Fails with the first place that no posture continues to.
[[nodiscard]] Result<std::vector<ContactPosture>> follow(const ArmModel& arm, double rail_m,
                                                         std::span<const ContactGoal> path,
                                                         const JointVector& near_rad,
                                                         const PostureOptions& options = {});

/// Place of the linear base, m, at which each arm reaches all its goals, as dexterous as can be at
/// the worst of them. Fails with how many goals are reached at best, and from where.
[[nodiscard]] Result<double> choose_rail(const PerArm<const ArmModel*>& arms,
                                         const RobotMount& mount,
                                         const PerArm<std::vector<ContactGoal>>& goals,
                                         const PerArm<JointVector>& near_rad,
                                         const PostureOptions& options = {});

}  // namespace tuina::robot
