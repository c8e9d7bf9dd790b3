// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/tool_motion.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::control {
namespace {

// Three axes, the first along `direction`.
Matrix3 axes_along(const Vector3& direction) {
  if (direction.norm() < 1e-9) return Matrix3::Identity();
  Matrix3 axes;
  axes.col(0) = direction.normalized();
  axes.col(1) = axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

// The shortest rotation vector w with exp(w) from = to.
Vector3 rotation_between(const Vector3& from, const Vector3& to) {
  const Vector3 axis = from.cross(to);
  const double sine = axis.norm();
  const double angle = std::atan2(sine, from.dot(to));
  if (sine < 1e-12) return angle < 1.0 ? Vector3(axis) : Vector3(angle * from.unitOrthogonal());
  return axis * (angle / sine);
}

Vector3 turned(const Vector3& normal, const Vector3& w) {
  const double angle = w.norm();
  if (angle < 1e-12) return (normal + w.cross(normal)).normalized();
  return Eigen::AngleAxisd(angle, w / angle) * normal;
}

// Plans three axes towards zero within the limit of the velocity's norm: the first axis gets what
// the lateral motion left over from an interruption does not need.
bool plan_axes(std::array<MotionProfile, 3>& axes, const Matrix3& base_from_axes, const Vector3& at,
               const Vector3& velocity, const Vector3& acceleration, const MotionLimits& limits,
               double duration_s) {
  const Vector3 p = base_from_axes.transpose() * at;
  const Vector3 v = base_from_axes.transpose() * velocity;
  const Vector3 a = base_from_axes.transpose() * acceleration;
  const bool straight = v.tail<2>().norm() < 1e-6 * limits.speed_per_s &&
                        a.tail<2>().norm() < 1e-6 * limits.acceleration_per_s2;
  const double along = straight ? 1.0 : 0.8, across = 0.42;
  Vector2 coast;
  for (int i = 0; i < 2; ++i) {
    coast[i] = std::abs(v[1 + i]) + a[1 + i] * a[1 + i] / (2.0 * across * limits.jerk_per_s3);
  }
  const double left = std::sqrt(
      std::max(1.0 - coast.squaredNorm() / (limits.speed_per_s * limits.speed_per_s), 0.0));
  const std::array<double, 3> speed_share = {straight ? 1.0 : std::clamp(left, 0.2, 0.8), across,
                                             across};
  const std::array<double, 3> other_share = {along, across, across};
  bool planned = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const MotionLimits share = {speed_share[i] * limits.speed_per_s,
                                other_share[i] * limits.acceleration_per_s2,
                                other_share[i] * limits.jerk_per_s3};
    const auto k = static_cast<Eigen::Index>(i);
    planned = planned && axes[i].plan_in(duration_s, {p[k], v[k], a[k]}, 0.0, share);
  }
  return planned;
}

double longest(const std::array<MotionProfile, 3>& axes) {
  return std::max({axes[0].duration_s(), axes[1].duration_s(), axes[2].duration_s()});
}

Vector3 value(const std::array<MotionProfile, 3>& axes, double time_s) {
  return {axes[0].at(time_s).at, axes[1].at(time_s).at, axes[2].at(time_s).at};
}

Vector3 speed(const std::array<MotionProfile, 3>& axes, double time_s) {
  return {axes[0].at(time_s).speed_per_s, axes[1].at(time_s).speed_per_s,
          axes[2].at(time_s).speed_per_s};
}

Vector3 acceleration(const std::array<MotionProfile, 3>& axes, double time_s) {
  return {axes[0].at(time_s).acceleration_per_s2, axes[1].at(time_s).acceleration_per_s2,
          axes[2].at(time_s).acceleration_per_s2};
}

}  // namespace

void ToolMotion::start(const ToolPose& pose) noexcept {
  *this = ToolMotion();
  goal_ = pose;
}

bool ToolMotion::plan(double time_s, const ToolPose& goal, const Limits& limits) noexcept {
  if (!goal.at_in_base.allFinite() || !goal.normal_in_base.allFinite() ||
      goal.normal_in_base.norm() < 1e-6) {
    return false;
  }
  ToolMotion next;
  next.goal_ = {goal.at_in_base, goal.normal_in_base.normalized()};
  const ToolReference now = at(time_s);

  const Vector3 to_goal = now.pose.at_in_base - next.goal_.at_in_base;
  next.base_from_travel_ = axes_along(-to_goal);
  const Vector3 travel_acceleration = base_from_travel_ * acceleration(travel_, time_s);

  // Rotation vectors are relative to the goal normal, so a new goal means new coordinates. The
  // state is converted by sampling the old motion at three instants.
  constexpr double h = 1e-4;
  const auto turn_at = [&](double t) {
    return rotation_between(next.goal_.normal_in_base, at(t).pose.normal_in_base);
  };
  const Vector3 turn = turn_at(time_s);
  Vector3 turn_speed = Vector3::Zero(), turn_acceleration = Vector3::Zero();
  if (time_s < duration_s_) {
    const double t = std::max(time_s, h);
    const Vector3 before = turn_at(t - h), behind = turn_at(t + h), here = turn_at(t);
    turn_speed = (behind - before) / (2.0 * h);
    turn_acceleration = (behind - 2.0 * here + before) / (h * h);
  }
  next.base_from_turn_ = axes_along(-turn);

  double duration_s = 0.0;
  for (int round = 0; round < 2; ++round) {
    if (!plan_axes(next.travel_, next.base_from_travel_, to_goal, now.velocity_m_per_s,
                   travel_acceleration, limits.travel, duration_s) ||
        !plan_axes(next.turn_, next.base_from_turn_, turn, turn_speed, turn_acceleration,
                   limits.turning, duration_s)) {
      return false;
    }
    duration_s = std::max(longest(next.travel_), longest(next.turn_));
  }
  next.duration_s_ = duration_s;
  *this = next;
  return true;
}

ToolReference ToolMotion::at(double time_s) const noexcept {
  const Vector3 w = base_from_turn_ * value(turn_, time_s);
  const Vector3 w_speed = base_from_turn_ * speed(turn_, time_s);
  return {.pose = {goal_.at_in_base + base_from_travel_ * value(travel_, time_s),
                   turned(goal_.normal_in_base, w)},
          .velocity_m_per_s = base_from_travel_ * speed(travel_, time_s),
          .turning_rad_per_s = w_speed};
}

}  // namespace tuina::control
