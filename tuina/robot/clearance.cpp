// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/clearance.hpp"

#include <algorithm>
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

}  // namespace tuina::robot
