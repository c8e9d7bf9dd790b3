// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/free_path.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::motion {

double height_above_skin_m(const body::BackSurface& back, const Vector3& in_couch) {
  const body::SurfacePoint skin = back.nearest(in_couch);
  return (in_couch - skin.at_in_couch).dot(skin.normal_in_couch);
}

std::vector<control::ToolPose> free_path(const body::BackSurface& back, const ApproachPose& from,
                                         const ApproachPose& to, double clear_m,
                                         const Transform& base_from_couch) {
  const auto in_base = [&](const Vector3& at, const Vector3& normal) {
    return control::ToolPose{.at_in_base = base_from_couch * at,
                             .normal_in_base = base_from_couch.linear() * normal};
  };
  const Vector3 out = back.position() == BodyPosture::sitting ? Vector3::UnitY() : Vector3::UnitZ();
  const auto clear = [&](double lift_m) {
    constexpr int samples = 16;
    for (int i = 0; i <= samples; ++i) {
      const double u = static_cast<double>(i) / samples;
      const Vector3 at = (1 - u) * from.at_in_couch + u * to.at_in_couch + lift_m * out;
      if (height_above_skin_m(back, at) < clear_m) return false;
    }
    return true;
  };
  constexpr double rise_m = 15_mm, max_m = 240_mm;
  double lift_m = 0.0;
  while (!clear(lift_m) && lift_m < max_m) lift_m += rise_m;
  std::vector<control::ToolPose> way;
  if (lift_m > 0.0) {
    way.push_back(in_base(from.at_in_couch + lift_m * out, from.normal_in_couch));
    way.push_back(in_base(to.at_in_couch + lift_m * out, to.normal_in_couch));
  }
  way.push_back(in_base(to.at_in_couch, to.normal_in_couch));
  return way;
}

double lift_over_back_m(double chord_m) noexcept {
  constexpr double radius_m = 150_mm, max_m = 80_mm;
  const double half_m = std::min(0.5 * chord_m, radius_m);
  return std::min(radius_m - std::sqrt(radius_m * radius_m - half_m * half_m), max_m);
}

double transfer_time_s(const control::ToolPose& from, const std::vector<control::ToolPose>& way) {
  constexpr double settling_s = 0.3;
  double time_s = 0.0;
  const control::ToolPose* start = &from;
  for (const control::ToolPose& goal : way) {
    control::ToolMotion motion;
    motion.start(*start);
    if (motion.plan(0.0, goal, {})) time_s += motion.duration_s() + settling_s;
    start = &goal;
  }
  return time_s;
}

}  // namespace tuina::motion
