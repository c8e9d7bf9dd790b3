// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "tuina/scanner/triangulation.hpp"

namespace tuina::test {

/// RMS over the rows of the image of the range that a calibration tells wrongly at a depth, for
/// places that the camera of the true scanner sees.
inline double range_error_m(const scanner::ScannerCalibration& truth,
                            const scanner::ScannerCalibration& believed, double depth_m) {
  double sum2 = 0.0;
  int rows = 0;
  for (int row = 0; row < truth.camera.height_px; row += 8) {
    const double y = (row - truth.camera.cy_px) / truth.camera.fy_px * depth_m;
    const Vector3& normal = truth.laser_normal_in_camera;
    const double x = (truth.laser_distance_m - normal.y() * y - normal.z() * depth_m) / normal.x();
    const Vector3 point(x, y, depth_m);
    const Vector2 pixel = scanner::project(truth.camera, point);
    if (pixel.x() < 0.0 || pixel.x() > truth.camera.width_px - 1.0) continue;
    const auto seen = scanner::triangulate(believed, pixel.x(), pixel.y());
    if (!seen) return INFINITY;
    sum2 += std::pow(seen->norm() - point.norm(), 2);
    ++rows;
  }
  return rows > 0 ? std::sqrt(sum2 / rows) : INFINITY;
}

}  // namespace tuina::test
