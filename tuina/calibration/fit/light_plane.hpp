// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::calibration {

/// Minimum number of points of a line on a board.
inline constexpr std::size_t min_line_points = 12;

/// A point of the laser line on a board.
struct LineOnBoard {
  double column_px = 0.0;
  double row_px = 0.0;
  double deviation_px = 0.0;
  Vector3 at_in_camera = Vector3::Zero();
};

/// The part of the line that lies on the board.
[[nodiscard]] std::vector<LineOnBoard> line_on_board(const View& view, const Board& board,
                                                     const scanner::CameraModel& camera,
                                                     const Transform& camera_from_board);

/// Points X with normal . X = distance, in the camera frame.
struct LightPlane {
  Vector3 normal = Vector3::UnitX();
  double distance_m = 0.0;
};

/// Fits the light plane to the line on all boards, robust against outlier poses. Fails with the
/// cause when poses contradict each other: mirrored pictures, laser pictures swapped between poses,
/// or else.
[[nodiscard]] Result<LightPlane> find_light_plane(const Views& views,
                                                  const scanner::CameraModel& camera,
                                                  const std::vector<Transform>& camera_from_board);

/// A pose whose line does not lie in the light plane, as when it passes beside the board.
struct LineOff {
  std::size_t view = 0;
  double off_m = 0.0;  ///< median distance of the line from the plane
};
/// Poses whose line is too far from the light plane.
[[nodiscard]] std::vector<LineOff> lines_off(const LightPlane& plane, const Views& views,
                                             const scanner::CameraModel& camera,
                                             const std::vector<Transform>& camera_from_board);

}  // namespace tuina::calibration
