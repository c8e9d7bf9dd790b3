// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "tuina/core/geometry.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// Undistorted viewing direction (x/z, y/z, 1) of a pixel.
[[nodiscard]] Vector3 ray_through(const CameraModel& camera, double column_px, double row_px);

/// Pixel (column, row) of a point in front of the camera, with distortion.
[[nodiscard]] Vector2 project(const CameraModel& camera, const Vector3& point_in_camera);

/// Intersection of a pixel's ray with the light plane; nothing behind the camera.
[[nodiscard]] std::optional<Vector3> triangulate(const ScannerCalibration& calibration,
                                                 double column_px, double row_px);

/// Range error per pixel of line shift at a point of the light plane, generalising [thesis] (4.3).
[[nodiscard]] double range_m_per_px(const ScannerCalibration& calibration,
                                    const Vector3& point_in_camera);

/// Range of columns in which the light plane appears between two depths.
[[nodiscard]] std::pair<int, int> columns_between(const ScannerCalibration& calibration,
                                                  double near_m, double far_m);

}  // namespace tuina::scanner
