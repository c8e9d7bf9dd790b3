// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/ray_scene.hpp"

namespace tuina::sim {

ScanTruth compare_with_truth(const PointCloud& cloud_in_couch, const Mesh& skin_in_couch) {
  constexpr double couch_top_m = 15.0_mm;
  constexpr double outlier_m = 5.0_mm;
  const RayScene skin(skin_in_couch);
  ScanTruth truth;
  double sum = 0.0, sum2 = 0.0;
  for (const Vector3& point : cloud_in_couch.points) {
    if (point.z() < couch_top_m) continue;
    const double height_m = skin.height_over(point), distance_m = std::abs(height_m);
    sum += height_m;
    sum2 += distance_m * distance_m;
    truth.worst_error_m = std::max(truth.worst_error_m, distance_m);
    ++truth.points;
    truth.outliers += distance_m > outlier_m ? 1U : 0U;
  }
  if (truth.points == 0) return truth;
  truth.mean_error_m = sum / static_cast<double>(truth.points);
  truth.rms_error_m = std::sqrt(sum2 / static_cast<double>(truth.points));
  return truth;
}

double seen_share(const VisibleRows& visible, const scanner::Scan& scan) {
  std::size_t seen = 0;
  for (std::size_t frame = 0; frame < visible.of_frame.size(); ++frame) {
    for (std::size_t i = scan.first_of_frame[frame]; i < scan.first_of_frame[frame + 1]; ++i) {
      seen += visible.of_frame[frame][scan.rows[i]] ? 1U : 0U;
    }
  }
  return static_cast<double>(seen) / static_cast<double>(std::max<std::size_t>(1, visible.count));
}

double range_error_m(const scanner::ScannerCalibration& truth,
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

}  // namespace tuina::sim
