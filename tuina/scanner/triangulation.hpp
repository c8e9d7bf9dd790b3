// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "tuina/core/geometry.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// The direction (x/z, y/z, 1) in which a pixel looks, lens distortion removed.
[[nodiscard]] Vector3 ray_through(const CameraModel& camera, double column_px, double row_px);

/// Where a point in front of the camera appears (column, row), lens distortion included.
[[nodiscard]] Vector2 project(const CameraModel& camera, const Vector3& point_in_camera);

/// Where the ray of a pixel meets the light plane, or nothing when it does not in front of the
/// camera.
[[nodiscard]] std::optional<Vector3> triangulate(const ScannerCalibration& calibration,
                                                 double column_px, double row_px);

/// Range error per pixel of line shift at a point of the light plane: the general form of [thesis]
/// (4.3).
[[nodiscard]] double range_m_per_px(const ScannerCalibration& calibration,
                                    const Vector3& point_in_camera);

/// First and last column in which the light plane can appear between two depths.
[[nodiscard]] std::pair<int, int> columns_between(const ScannerCalibration& calibration,
                                                  double near_m, double far_m);

}  // namespace tuina::scanner
