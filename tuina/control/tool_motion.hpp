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
/// together. The path is straight and the normal turns about one axis. Where the new goal is not on
/// the line of a motion under way, that comes to rest first: speed, acceleration and jerk keep
/// within their limits whatever the goals.
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
  /// Motion along one direction, or about one axis: what was under way comes to rest, then the way
  /// to the goal.
  struct Way {
    Vector3 stop_axis = Vector3::UnitX(), axis = Vector3::UnitX();  // unit, in base
    MotionProfile stop;                                             // from where it was planned
    MotionState begins;  // state in which the way to the goal begins, before the goal
    MotionProfile rest;  // to the goal, which is zero

    /// Goes on from another way at a time of that: along its line if it leads to the goal. False as
    /// in `MotionProfile::plan`.
    [[nodiscard]] bool go_on(const Way& from, double time_s, bool leads_there,
                             const MotionLimits& limits) noexcept;
    /// Plans the way to the goal so that both last so long, or as long as they must.
    [[nodiscard]] bool plan_in(double duration_s, const MotionLimits& limits) noexcept;
    [[nodiscard]] bool stops(double time_s) const noexcept { return time_s < stop.duration_s(); }
    [[nodiscard]] MotionState at(double time_s) const noexcept;
    [[nodiscard]] const Vector3& axis_at(double time_s) const noexcept;
    [[nodiscard]] double duration_s() const noexcept;
  };
  [[nodiscard]] ToolPose pose_at(double time_s) const noexcept;
  [[nodiscard]] ToolPose pose_at_stop() const noexcept;

  ToolPose from_;  // where it was planned
  ToolPose goal_;
  double duration_s_ = 0.0;
  Way travel_, turn_;  // m and rad
};

}  // namespace tuina::control
