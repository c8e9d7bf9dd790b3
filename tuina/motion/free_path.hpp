// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/control/tool_motion.hpp"
#include "tuina/core/contact.hpp"

namespace tuina::motion {

/// A place in the air above the skin, and which way the tool looks there.
struct Hover {
  Vector3 at_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitZ();
};

[[nodiscard]] inline Hover hover_over(const ContactPoint& point, double standoff_m) {
  return {.at_in_couch = point.at_in_couch + standoff_m * point.normal_in_couch,
          .normal_in_couch = point.normal_in_couch};
}

/// Foremost point and normal of a tool.
[[nodiscard]] inline control::ToolPose foremost_of(const Transform& base_from_tool,
                                                   double radius_m) noexcept {
  const Vector3 normal = control::tool_normal(base_from_tool);
  return {.at_in_base = base_from_tool.translation() - radius_m * normal, .normal_in_base = normal};
}

[[nodiscard]] inline control::ToolPose above(const control::ToolPose& pose,
                                             double more_m) noexcept {
  return {.at_in_base = pose.at_in_base + more_m * pose.normal_in_base,
          .normal_in_base = pose.normal_in_base};
}

/// Straight through the air where that stays clear of the back; else up, over and down, just high
/// enough.
[[nodiscard]] std::vector<control::ToolPose> way_between(const body::BackSurface& back,
                                                         const Hover& from, const Hover& to,
                                                         double clear_m,
                                                         const Transform& base_from_couch);

/// How long the tool is on its way, from rest to rest at every waypoint.
[[nodiscard]] double time_of_way_s(const control::ToolPose& from,
                                   const std::vector<control::ToolPose>& way);

}  // namespace tuina::motion
