// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/geometry.hpp"

namespace ceres {
class CostFunction;
}

namespace tuina::calibration {

// Residuals of the joint fit, in standard deviations. Parameter blocks: camera (fx, fy, cx, cy, k1,
// k2, p1, p2), board pose (rotation vector, translation), light plane (normal / distance), axis
// (two tilts and two shifts from the initial axis), yaw. The caller (Ceres) owns the cost
// functions.
inline constexpr int camera_size = 8;
inline constexpr int light_size = 3;
inline constexpr int axis_size = 4;
inline constexpr int usual_lens_size = 4;  ///< residuals of near_usual_lens

/// A detected board corner.
struct SeenCorner {
  Vector2 seen_px;
  Vector3 at;  ///< in the board frame
  double deviation_px = 1.0;
};
/// Blocks: camera, pose.
[[nodiscard]] ceres::CostFunction* corner_of_board(const SeenCorner& corner);

/// The initial axis, and two directions perpendicular to it and to each other.
struct FirstAxis {
  Vector3 direction, point, aside_1, aside_2;
};
/// A corner of a standing board after the unit has turned from one yaw to another. Blocks: camera,
/// pose, axis, both yaws.
[[nodiscard]] ceres::CostFunction* corner_of_standing_board(const SeenCorner& corner,
                                                            const FirstAxis& axis);

/// A line point: the ray's intersection with the board must lie on the light plane; the distance
/// counts in pixels across the line.
struct SeenLinePoint {
  double column_px = 0.0;
  double row_px = 0.0;
  double per_px = 1.0;  ///< change of normal . X / distance per pixel of line shift
  double deviation_px = 1.0;
};
/// Blocks: camera, pose, light plane.
[[nodiscard]] ceres::CostFunction* point_of_line(const SeenLinePoint& point);
/// normal . X / distance of a line point; 1 on the light plane.
[[nodiscard]] double light_value(const double* camera, const double* light,
                                 const Transform& camera_from_board, double column_px,
                                 double row_px);

/// Gaussian prior of one number.
[[nodiscard]] ceres::CostFunction* near_value(double value, double deviation);
/// Prior of the distortion of usual webcams. Without it a few boards would fit distortion to their
/// noise.
[[nodiscard]] ceres::CostFunction* near_usual_lens();

}  // namespace tuina::calibration
