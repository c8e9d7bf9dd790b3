// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/motion_profile.hpp"

namespace tuina::control {

/// Place (tip or centre, as its name says) and outward axis of a tool; rotation about the axis
/// is free.
struct ToolPose {
  Vector3 at_in_base = Vector3::Zero();
  Vector3 normal_in_base = Vector3::UnitZ();  ///< unit, out of the body, along the tool's shaft
};

/// Outward axis of the tool: minus the x axis of the `tool` frame.
[[nodiscard]] inline Vector3 tool_normal(const Transform& base_from_tool) noexcept {
  return -base_from_tool.linear().col(0);
}

/// Tip of a sphere tool: its point farthest along the shaft, which touches the skin first.
[[nodiscard]] inline ToolPose tip_pose(const Transform& base_from_tool, double radius_m) noexcept {
  const Vector3 normal = tool_normal(base_from_tool);
  return {.at_in_base = base_from_tool.translation() - radius_m * normal, .normal_in_base = normal};
}

/// Centre of the sphere whose tip is at a pose: the origin of the `tool` frame.
[[nodiscard]] inline ToolPose centre_pose(const ToolPose& tip, double radius_m) noexcept {
  return {.at_in_base = tip.at_in_base + radius_m * tip.normal_in_base,
          .normal_in_base = tip.normal_in_base};
}

/// Where the tool should be now, and how it should move, in base.
struct ToolReference {
  ToolPose pose;
  Vector3 velocity_m_per_s = Vector3::Zero();
  Vector3 turning_rad_per_s = Vector3::Zero();
};

/// Jerk-limited motion of the tool from any state to rest at a pose; position and normal arrive
/// together. From rest the path is straight and the normal turns about one axis.
class ToolMotion {
 public:
  /// Limits of the way of the tool's centre and of its turning.
  struct Limits {
    MotionLimits travel = {0.20, 0.6, 6.0};   ///< m/s, m/s2, m/s3
    MotionLimits turning = {0.8, 3.0, 30.0};  ///< rad/s, rad/s2, rad/s3
  };

  /// At rest at this pose.
  void start(const ToolPose& pose) noexcept;

  /// Replans from the state at `time_s`; `at` then counts from zero. False for a non-finite goal or
  /// a zero normal; the old motion stays.
  [[nodiscard]] bool plan(double time_s, const ToolPose& goal, const Limits& limits) noexcept;

  /// Reference at a time on the clock of `plan`; at rest at the goal afterwards.
  [[nodiscard]] ToolReference at(double time_s) const noexcept;
  [[nodiscard]] double duration_s() const noexcept { return duration_s_; }
  /// Pose that it comes to rest at.
  [[nodiscard]] const ToolPose& goal() const noexcept { return goal_; }

 private:
  ToolPose goal_;
  double duration_s_ = 0.0;
  Matrix3 base_from_travel_ = Matrix3::Identity();  // first axis: towards the goal
  Matrix3 base_from_turn_ = Matrix3::Identity();    // first axis: rotation axis to the goal
  std::array<MotionProfile, 3> travel_;             // relative to the goal, in base_from_travel_
  std::array<MotionProfile, 3> turn_;               // rotation vector from the goal normal
};

}  // namespace tuina::control
