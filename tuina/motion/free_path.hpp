// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/control/tool_motion.hpp"
#include "tuina/core/contact.hpp"

namespace tuina::motion {

/// A tool pose in the air above the skin.
struct ApproachPose {
  Vector3 at_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitZ();
};

/// The pose `standoff_m` above a point, along its normal.
[[nodiscard]] inline ApproachPose approach_pose(const ContactPoint& point, double standoff_m) {
  return {.at_in_couch = point.at_in_couch + standoff_m * point.normal_in_couch,
          .normal_in_couch = point.normal_in_couch};
}

/// The pose `more_m` higher, along its normal.
[[nodiscard]] inline control::ToolPose above(const control::ToolPose& pose,
                                             double more_m) noexcept {
  return {.at_in_base = pose.at_in_base + more_m * pose.normal_in_base,
          .normal_in_base = pose.normal_in_base};
}

/// Height of a point above the nearest skin; negative inside the person.
[[nodiscard]] double height_above_skin_m(const body::BackSurface& back, const Vector3& in_couch);

/// Waypoints of a transfer: straight if that keeps `clear_m` above the back, else up, over and
/// down, as low as possible, but no higher than 240 mm; where that is not enough it comes nearer.
[[nodiscard]] std::vector<control::ToolPose> free_path(const body::BackSurface& back,
                                                       const ApproachPose& from,
                                                       const ApproachPose& to, double clear_m,
                                                       const Transform& base_from_couch);

/// Lift that keeps a straight way between two places over a back as high above the skin as its ends
/// are: the rise of an arc of 150 mm radius, the tightest curve of a back, over that chord.
[[nodiscard]] double lift_over_back_m(double chord_m) noexcept;

/// Duration of a transfer with a stop at every waypoint.
[[nodiscard]] double transfer_time_s(const control::ToolPose& from,
                                     const std::vector<control::ToolPose>& way);

}  // namespace tuina::motion
