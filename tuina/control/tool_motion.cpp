// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/tool_motion.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::control {
namespace {

// A goal so near to the line or the circle of a motion under way is on it.
constexpr double on_line_m = 1e-9, on_circle_rad = 1e-9;

Vector3 turned(const Vector3& normal, const Vector3& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis) * normal;
}

// The axis, across both, about which `from` turns into `to` by the smaller angle.
Vector3 axis_between(const Vector3& from, const Vector3& to) {
  const Vector3 axis = from.cross(to);
  return axis.norm() > 1e-12 ? Vector3(axis.normalized()) : Vector3(from.unitOrthogonal());
}

// Angle about `axis`, which is across both, that turns `from` into `to`.
double angle_about(const Vector3& axis, const Vector3& from, const Vector3& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}

}  // namespace

bool ToolMotion::Way::go_on(const Way& from, double time_s, bool leads_there,
                            const MotionLimits& limits) noexcept {
  begins = from.at(time_s);
  begins.at = 0.0;
  const bool moves = begins.speed_per_s != 0.0 || begins.acceleration_per_s2 != 0.0;
  if (!moves || leads_there) {
    axis = from.axis_at(time_s);
    return true;
  }
  stop_axis = from.axis_at(time_s);
  const bool stops = stop.plan_stop(begins, limits);
  begins = {};
  return stops;
}

bool ToolMotion::Way::plan_in(double duration_s, const MotionLimits& limits) noexcept {
  return rest.plan_in(duration_s - stop.duration_s(), begins, 0.0, limits);
}

MotionState ToolMotion::Way::at(double time_s) const noexcept {
  return stops(time_s) ? stop.at(time_s) : rest.at(time_s - stop.duration_s());
}

const Vector3& ToolMotion::Way::axis_at(double time_s) const noexcept {
  return stops(time_s) ? stop_axis : axis;
}

double ToolMotion::Way::duration_s() const noexcept {
  return stop.duration_s() + rest.duration_s();
}

void ToolMotion::start(const ToolPose& pose) noexcept {
  *this = ToolMotion();
  from_ = goal_ = pose;
}

// Turned aside at full speed a tool would exceed its limits, and no turn about a goal that lies
// nearly opposite has coordinates that stay bounded: so a tool comes to rest before it leaves its
// line.
bool ToolMotion::plan(double time_s, const ToolPose& goal, const Limits& limits) noexcept {
  if (!goal.at_in_base.allFinite() || !goal.normal_in_base.allFinite() ||
      goal.normal_in_base.norm() < 1e-6) {
    return false;
  }
  ToolMotion next;
  next.from_ = pose_at(time_s);
  next.goal_ = {goal.at_in_base, goal.normal_in_base.normalized()};
  const Vector3 to_goal = next.goal_.at_in_base - next.from_.at_in_base;
  const bool on_line = to_goal.cross(travel_.axis_at(time_s)).norm() < on_line_m;
  const auto along_axis = [&](const ToolPose& pose) {
    return std::abs(pose.normal_in_base.dot(turn_.axis_at(time_s)));
  };
  const bool on_circle = along_axis(next.from_) + along_axis(next.goal_) < on_circle_rad;
  if (!next.travel_.go_on(travel_, time_s, on_line, limits.travel) ||
      !next.turn_.go_on(turn_, time_s, on_circle, limits.turning)) {
    return false;
  }

  const ToolPose stop = next.pose_at_stop();
  const Vector3 way = next.goal_.at_in_base - stop.at_in_base;
  if (!on_line && way.norm() > 0.0) next.travel_.axis = way.normalized();
  next.travel_.begins.at = -way.dot(next.travel_.axis);
  if (!on_circle) next.turn_.axis = axis_between(stop.normal_in_base, next.goal_.normal_in_base);
  next.turn_.begins.at =
      -angle_about(next.turn_.axis, stop.normal_in_base, next.goal_.normal_in_base);

  for (int round = 0; round < 2; ++round) {
    if (!next.travel_.plan_in(next.duration_s_, limits.travel) ||
        !next.turn_.plan_in(next.duration_s_, limits.turning)) {
      return false;
    }
    next.duration_s_ = std::max(next.travel_.duration_s(), next.turn_.duration_s());
  }
  *this = next;
  return true;
}

ToolPose ToolMotion::pose_at_stop() const noexcept {
  return {from_.at_in_base + travel_.stop.goal() * travel_.stop_axis,
          turned(from_.normal_in_base, turn_.stop_axis, turn_.stop.goal())};
}

ToolPose ToolMotion::pose_at(double time_s) const noexcept {
  const double travelled_m = travel_.at(time_s).at, turned_rad = turn_.at(time_s).at;
  return {
      (travel_.stops(time_s) ? from_ : goal_).at_in_base + travelled_m * travel_.axis_at(time_s),
      turned((turn_.stops(time_s) ? from_ : goal_).normal_in_base, turn_.axis_at(time_s),
             turned_rad)};
}

ToolReference ToolMotion::at(double time_s) const noexcept {
  return {.pose = pose_at(time_s),
          .velocity_m_per_s = travel_.at(time_s).speed_per_s * travel_.axis_at(time_s),
          .turning_rad_per_s = turn_.at(time_s).speed_per_s * turn_.axis_at(time_s)};
}

}  // namespace tuina::control
