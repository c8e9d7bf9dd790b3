// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/clearance.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace tuina::robot {
namespace {

struct Segment {
  Vector3 from, to;
};

/// The closest points of two lines, clamped onto one segment and then onto the other
/// ([ericson2005] 5.1.9).
double distance_m(const Segment& a, const Segment& b) noexcept {
  const Vector3 along_a = a.to - a.from, along_b = b.to - b.from, between = a.from - b.from;
  const double aa = along_a.squaredNorm(), bb = along_b.squaredNorm();
  constexpr double point = 1e-12;
  const double ab = along_a.dot(along_b), a_between = along_a.dot(between),
               b_between = along_b.dot(between);
  const double parallel = aa * bb - ab * ab;
  const auto share = [](double part, double whole) {
    return whole > point ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
  };
  const double first_guess = share(ab * b_between - a_between * bb, parallel);
  const double on_b = share(ab * first_guess + b_between, bb);
  const double on_a = share(ab * on_b - a_between, aa);
  return (a.from + on_a * along_a - b.from - on_b * along_b).norm();
}

}  // namespace

double distance_between_m(const ArmModel& one, const ArmModel::Kinematics& one_pose,
                          const ArmModel& other, const ArmModel::Kinematics& other_pose) noexcept {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < one.joints(); ++i) {
    const auto a = static_cast<std::size_t>(i);
    const Segment link{one_pose.origins_in_base[a], one_pose.origins_in_base[a + 1]};
    for (int j = 0; j < other.joints(); ++j) {
      const auto b = static_cast<std::size_t>(j);
      const Segment other_link{other_pose.origins_in_base[b], other_pose.origins_in_base[b + 1]};
      const double radii_m = one.table().links[a].radius_m + other.table().links[b].radius_m;
      nearest_m = std::min(nearest_m, distance_m(link, other_link) - radii_m);
    }
  }
  return nearest_m;
}

double segment_to_box_m(const Vector3& from, const Vector3& to, const Vector3& half_m) noexcept {
  const Vector3 along = to - from;
  // How far the place at t sticks out of the box along each axis.
  const auto beyond = [&](double t) {
    const Vector3 at = from + t * along;
    return Vector3(at - at.cwiseMax(-half_m).cwiseMin(half_m));
  };
  // The square of the distance is convex and, between the planes of the box's faces, quadratic: its
  // slope is found to be zero in one of those stretches.
  std::array<double, 8> stretches = {0.0, 1.0};  // in order
  std::size_t count = 2;
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] == 0.0) continue;
    for (const double face : {-half_m[axis], half_m[axis]}) {
      const double t = (face - from[axis]) / along[axis];
      if (!(t > 0.0 && t < 1.0)) continue;
      std::size_t place = count++;
      for (; stretches[place - 1] > t; --place) stretches[place] = stretches[place - 1];
      stretches[place] = t;
    }
  }
  double low = 0.0, low_slope = beyond(0.0).dot(along);
  if (low_slope >= 0.0) return beyond(0.0).norm();
  for (std::size_t i = 1; i < count; ++i) {
    const double high = stretches[i], high_slope = beyond(high).dot(along);
    if (high_slope >= 0.0) {
      const double change = high_slope - low_slope;
      return beyond(low - (change > 0.0 ? low_slope * (high - low) / change : 0.0)).norm();
    }
    low = high;
    low_slope = high_slope;
  }
  return beyond(1.0).norm();
}

Clearances clearances(const ArmModel& arm, const ArmModel::Kinematics& pose, double rail_m,
                      std::span<const Obstacle> obstacles) noexcept {
  constexpr double point_m = 1e-6;
  Clearances nearest;
  const std::size_t elbow = arm.elbow();
  const Vector3 ridden_m = arm.shoulder_in_base(rail_m) - arm.shoulder_in_base(0.0);
  for (const Obstacle& obstacle : obstacles) {
    const Matrix3 box_from_base = obstacle.base_from_box.linear().transpose();
    Vector3 middle = obstacle.base_from_box.translation();
    if (obstacle.rides) middle += ridden_m;
    const Vector3 half_m = 0.5 * obstacle.edges_m;
    for (std::size_t i = elbow; i < static_cast<std::size_t>(arm.joints()); ++i) {
      const Vector3& from = pose.origins_in_base[i];
      const Vector3& to = pose.origins_in_base[i + 1];
      if ((to - from).squaredNorm() < point_m * point_m) continue;  // a joint without a length
      const double apart_m =
          segment_to_box_m(box_from_base * (from - middle), box_from_base * (to - middle), half_m) -
          arm.table().links[i].radius_m;
      double& min_m = nearest[obstacle.kind];
      min_m = std::min(min_m, apart_m);
    }
  }
  return nearest;
}

}  // namespace tuina::robot
