// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuina::scanner {
namespace {

// OpenCV's distortion (k1, k2, p1, p2, k3) on normalised coordinates.
Vector2 distort(const CameraModel& camera, const Vector2& straight) {
  const auto [k1, k2, p1, p2, k3] = camera.distortion;
  const double x = straight.x();
  const double y = straight.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

}  // namespace

Vector3 ray_through(const CameraModel& camera, double column_px, double row_px) {
  const Vector2 seen((column_px - camera.cx_px) / camera.fx_px,
                     (row_px - camera.cy_px) / camera.fy_px);
  Vector2 straight = seen;
  // Fixed-point iteration, since the model has no closed inverse; each step shrinks the error by
  // about the distortion.
  for (int step = 0; step < 20; ++step) {
    const Vector2 error = distort(camera, straight) - seen;
    straight -= error;
    if (error.squaredNorm() < 1e-24) break;
  }
  return {straight.x(), straight.y(), 1.0};
}

Vector2 project(const CameraModel& camera, const Vector3& point_in_camera) {
  const Vector2 bent = distort(camera, point_in_camera.head<2>() / point_in_camera.z());
  return {bent.x() * camera.fx_px + camera.cx_px, bent.y() * camera.fy_px + camera.cy_px};
}

std::optional<Vector3> triangulate(const ScannerCalibration& calibration, double column_px,
                                   double row_px) {
  const Vector3 ray = ray_through(calibration.camera, column_px, row_px);
  const double depth_m = calibration.laser_distance_m / calibration.laser_normal_in_camera.dot(ray);
  if (!(depth_m > 0.0) || !std::isfinite(depth_m)) return {};
  return Vector3(depth_m * ray);
}

double range_m_per_px(const ScannerCalibration& calibration, const Vector3& point_in_camera) {
  // The ray r = (x/z, y/z, 1) meets the plane at t = d / (n . r), so dt/du = -t^2 n_x / (d fx);
  // with the thesis' upright laser this is D^2 / (f L), (4.3). The point moves along r.
  return std::abs(calibration.laser_normal_in_camera.x() /
                  (calibration.laser_distance_m * calibration.camera.fx_px)) *
         point_in_camera.z() * point_in_camera.norm();
}

std::pair<int, int> columns_between(const ScannerCalibration& calibration, double near_m,
                                    double far_m) {
  const CameraModel& camera = calibration.camera;
  const Vector3& normal = calibration.laser_normal_in_camera;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  // The plane may lean along the rows too, so columns are evaluated at both borders.
  for (const double row : {0.0, 0.5 * (camera.height_px - 1), camera.height_px - 1.0}) {
    const double y = (row - camera.cy_px) / camera.fy_px;
    for (const double z : {near_m, far_m}) {
      const double x =
          (calibration.laser_distance_m / z - normal.y() * y - normal.z()) / normal.x();
      const double column = project(camera, {x, y, 1.0}).x();
      low = std::min(low, column);
      high = std::max(high, column);
    }
  }
  constexpr double margin_px = 12.0;  // the line has a width
  const int last = camera.width_px - 1;
  if (!std::isfinite(low) || !std::isfinite(high)) return {0, last};
  return {std::clamp(static_cast<int>(std::max(low - margin_px, -1.0)), 0, last),
          std::clamp(static_cast<int>(std::min(high + margin_px, last + 1.0)), 0, last)};
}

}  // namespace tuina::scanner
