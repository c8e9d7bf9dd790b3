// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/range_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/scanner/triangulation.hpp"

namespace tuina::calibration {
namespace {

constexpr double line_noise_px = 0.1;
constexpr int row_step = 8;
constexpr int varied = axis_tilt_1;  // the axis does not affect the range

// The geometry with one parameter changed.
scanner::ScannerCalibration changed(const Geometry& geometry, int parameter, double by) {
  Geometry result = geometry;
  auto& camera = result.camera;
  const std::array<double*, 8> of_camera = {
      &camera.fx_px,         &camera.fy_px,         &camera.cx_px,         &camera.cy_px,
      &camera.distortion[0], &camera.distortion[1], &camera.distortion[2], &camera.distortion[3]};
  if (parameter < light_x) {
    *of_camera[static_cast<std::size_t>(parameter)] += by;
  } else {
    Vector3 light = geometry.light.normal / geometry.light.distance_m;
    light(parameter - light_x) += by;
    const double side = geometry.light.distance_m < 0.0 ? -1.0 : 1.0;
    result.light = {.normal = side * light.normalized(), .distance_m = side / light.norm()};
  }
  return calibration_of(result);
}

// Pixel of the light plane at a depth, in one image row.
std::optional<Vector2> pixel_at(const Geometry& geometry, double depth_m, double row_px) {
  const auto& camera = geometry.camera;
  Vector2 pixel(camera.cx_px, row_px);
  for (int i = 0; i < 8; ++i) {  // distortion couples rows and columns
    const Vector3 ray = scanner::ray_through(camera, pixel.x(), row_px);
    const Vector3& normal = geometry.light.normal;
    const double x =
        (geometry.light.distance_m / depth_m - normal.y() * ray.y() - normal.z()) / normal.x();
    pixel = scanner::project(camera, {x, ray.y(), 1.0});
  }
  if (!(pixel.x() >= 0.0 && pixel.x() <= camera.width_px - 1.0)) return std::nullopt;
  return Vector2(pixel.x(), row_px);
}

}  // namespace

double RangeError::total_m() const {
  return std::hypot(systematic_m, random_m);
}

scanner::ScannerCalibration calibration_of(const Geometry& geometry,
                                           const scanner::ScannerCalibration& base) {
  scanner::ScannerCalibration calibration = base;
  calibration.camera = geometry.camera;
  calibration.laser_normal_in_camera = geometry.light.normal;
  calibration.laser_distance_m = geometry.light.distance_m;
  calibration.axis_point_in_camera = geometry.axis.point_in_camera;
  calibration.axis_direction_in_camera = geometry.axis.direction_in_camera;
  return calibration;
}

std::optional<RangeError> expected_range_error(const Geometry& geometry,
                                               const Covariance& covariance, double depth_m) {
  std::array<scanner::ScannerCalibration, varied> more;
  std::array<scanner::ScannerCalibration, varied> less;
  std::array<double, varied> step{};
  for (int i = 0; i < varied; ++i) {
    const auto k = static_cast<std::size_t>(i);
    step[k] = 0.1 * std::sqrt(covariance(i, i));
    more[k] = changed(geometry, i, step[k]);
    less[k] = changed(geometry, i, -step[k]);
  }
  const auto middle = calibration_of(geometry);
  double systematic2 = 0.0;
  double random2 = 0.0;
  int rows = 0;
  for (int row = 0; row < geometry.camera.height_px; row += row_step) {
    const auto pixel = pixel_at(geometry, depth_m, row);
    if (!pixel) continue;
    const auto point = scanner::triangulate(middle, pixel->x(), pixel->y());
    if (!point) continue;
    Eigen::Matrix<double, varied, 1> slope;
    for (int i = 0; i < varied; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const auto far = scanner::triangulate(more[k], pixel->x(), pixel->y());
      const auto near = scanner::triangulate(less[k], pixel->x(), pixel->y());
      if (!far || !near) return std::nullopt;
      slope(i) = (far->norm() - near->norm()) / (2.0 * step[k]);
    }
    systematic2 += slope.dot(covariance.topLeftCorner<varied, varied>() * slope);
    random2 += std::pow(line_noise_px * scanner::range_m_per_px(middle, *point), 2);
    ++rows;
  }
  if (rows == 0) return std::nullopt;
  return RangeError{.systematic_m = std::sqrt(systematic2 / rows),
                    .random_m = std::sqrt(random2 / rows)};
}

Covariance covariance_to_state(const JointFit& fit) {
  double range = 0.0;
  double depths = 0.0;
  for (const double depth_m : reported_depths_m) {
    const auto of_rows = expected_range_error(fit.geometry, fit.covariance, depth_m);
    const auto of_poses = expected_range_error(fit.geometry, fit.covariance_of_poses, depth_m);
    if (!of_rows || !of_poses) continue;
    range += std::pow(of_poses->systematic_m / of_rows->systematic_m, 2);
    depths += 1.0;
  }
  // One factor for everything that affects the range: twenty poses determine no more. The axis
  // rests on a few standing boards, too few for a jackknife.
  Eigen::Matrix<double, parameters, 1> larger;
  larger.setOnes();
  larger.head<varied>().setConstant(std::sqrt(std::max(1.0, range / std::max(1.0, depths))));
  return larger.asDiagonal() * fit.covariance * larger.asDiagonal();
}

}  // namespace tuina::calibration
