// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/geometry.hpp"

namespace ceres {
class CostFunction;
}

namespace tuina::calibration {

// What the joint fit makes small, each in standard deviations. The parameters: a camera (fx, fy,
// cx, cy, k1, k2, p1, p2), the pose of a board (angle times axis, place), the light plane (normal /
// distance), the axis (two tilts and two shifts aside from where it was found first), a yaw. The
// caller, which is Ceres, owns what is made.
inline constexpr int camera_size = 8;
inline constexpr int light_size = 3;
inline constexpr int axis_size = 4;
inline constexpr int usual_lens_size = 4;  ///< residuals of near_usual_lens

/// A corner of a board, seen in a picture.
struct SeenCorner {
  Vector2 seen_px;
  Vector3 at;  ///< on the board
  double deviation_px = 1.0;
};
/// Of camera and pose.
[[nodiscard]] ceres::CostFunction* corner_of_board(const SeenCorner& corner);

/// The axis as it was found first, and two directions upright to it and to each other.
struct FirstAxis {
  Vector3 direction, point, aside_1, aside_2;
};
/// A corner of a standing board after the unit has turned on from one yaw to another: of camera,
/// pose, axis and both yaws.
[[nodiscard]] ceres::CostFunction* corner_of_standing_board(const SeenCorner& corner,
                                                            const FirstAxis& axis);

/// Where the ray of a line point meets the board it must lie on the light plane; the distance
/// counts in pixels across the line.
struct SeenLinePoint {
  double column_px = 0.0;
  double row_px = 0.0;
  double per_px = 1.0;  ///< change of normal . X / distance for one pixel of line
  double deviation_px = 1.0;
};
/// Of camera, pose and light plane.
[[nodiscard]] ceres::CostFunction* point_of_line(const SeenLinePoint& point);
/// normal . X / distance of that point, 1 on the light plane.
[[nodiscard]] double light_value(const double* camera, const double* light,
                                 const Transform& camera_from_board, double column_px,
                                 double row_px);

/// One number that is about known.
[[nodiscard]] ceres::CostFunction* near_value(double value, double deviation);
/// A distortion as webcams have it, of a camera: without it a few boards would find distortion in
/// their noise.
[[nodiscard]] ceres::CostFunction* near_usual_lens();

}  // namespace tuina::calibration
