// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <vector>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::sim {
namespace {

using scanner::CameraModel;
using scanner::ScannerCalibration;

// [thesis] 4.2: f 6.25 mm, pixel 6 um, 640 x 480, baseline 200 mm, laser leaning by 73 degrees,
// (4.11).
constexpr double focal_px = 6.25e-3 / 6e-6;
constexpr double baseline_m = 200.0_mm;
constexpr double lean_rad = 73.0_deg;
constexpr double reference_m = 1.1;  // usual distance of a back

// Errors after calibrating from 40 poses with 0.1 px of corner and line noise (docs/scanner.md).
constexpr int poses = 40;
constexpr double focal_error_px = 0.4;
constexpr double centre_error_px = 0.7;
constexpr double distortion_error = 2e-3;
constexpr double board_depth_error_per_m = 0.13_mm;  // at 1 m; grows with the square of the depth
constexpr double axis_error_rad = 0.03_deg;
constexpr double axis_error_m = 0.5_mm;
constexpr double latency_error_s = 0.002;
// The flat board on the couch and the mark on its middle are placed by hand.
constexpr double board_height_error_m = 0.3_mm;
constexpr double board_tilt_error_rad = 0.03_deg;

// Fits the light plane to points on boards as a calibration does: each board depth has the errors
// of focal length and corner noise. Total least squares, weighted by 1/z^2.
void fit_laser_plane(const ScannerCalibration& truth, ScannerCalibration& believed,
                     Random& random) {
  Vector3 middle = Vector3::Zero();
  double weights = 0.0;
  std::vector<std::pair<Vector3, double>> points;
  const double scale = believed.camera.fx_px / truth.camera.fx_px;
  for (int pose = 0; pose < poses; ++pose) {
    const double depth_m = uniform(random, 0.5, 1.75);
    const double tilt = std::tan(uniform(random, -35.0_deg, 35.0_deg));
    const double depth_error_m = gaussian(random, board_depth_error_per_m * depth_m * depth_m);
    const double tilt_error = gaussian(random, 0.05_deg);
    for (int row = 20; row < truth.camera.height_px; row += 40) {
      const double y = (row - truth.camera.cy_px) / truth.camera.fy_px * depth_m;
      const double z = depth_m + tilt * y;
      const Vector3& normal = truth.laser_normal_in_camera;
      const double x = (truth.laser_distance_m - normal.y() * y - normal.z() * z) / normal.x();
      const Vector2 pixel = scanner::project(truth.camera, {x, y, z});
      const Vector3 ray =
          scanner::ray_through(believed.camera, pixel.x() + gaussian(random, 0.1), pixel.y());
      const Vector3 point = ray * (scale * z + depth_error_m + tilt_error * y);
      const double weight = 1.0 / (z * z);
      points.emplace_back(point, weight);
      middle += weight * point;
      weights += weight;
    }
  }
  middle /= weights;
  Matrix3 spread = Matrix3::Zero();
  for (const auto& [point, weight] : points) {
    spread += weight * (point - middle) * (point - middle).transpose();
  }
  const PrincipalAxes principal = principal_axes(spread);
  Vector3 normal = principal.axes.col(0);
  if (normal.dot(truth.laser_normal_in_camera) < 0.0) normal = -normal;
  believed.laser_normal_in_camera = normal;
  believed.laser_distance_m = normal.dot(middle);
}

// True point of the light plane as located by the believed calibration.
std::optional<Vector3> seen_in_couch(const ScannerCalibration& truth,
                                     const ScannerCalibration& believed, const Vector3& at_in_couch,
                                     double yaw_rad) {
  const Vector2 pixel =
      scanner::project(truth.camera, truth.couch_from_camera_at(yaw_rad).inverse() * at_in_couch);
  const auto point = scanner::triangulate(believed, pixel.x(), pixel.y());
  if (!point) return {};
  return believed.couch_from_camera_at(yaw_rad) * *point;
}

// Couch pose as a user finds it: height and tilt from a scanned flat board, and at yaw 0 the line
// falls on the middle of the couch. The origin of x and y is the scanner's choice.
void place_on_couch(const ScannerCalibration& truth, ScannerCalibration& believed, Random& random) {
  Vector3 sum = Vector3::Zero();
  Matrix3 sums = Matrix3::Zero();
  const double tilt_x = std::tan(gaussian(random, board_tilt_error_rad));
  const double tilt_y = std::tan(gaussian(random, board_tilt_error_rad));
  const double height_m = gaussian(random, board_height_error_m);
  for (int step = -6; step <= 6; ++step) {
    const double yaw_rad = step * 2.0_deg;
    // The light plane at this yaw cuts the couch in a line along y; the board covers 0.4 m of it.
    const Transform couch_from_camera = truth.couch_from_camera_at(yaw_rad);
    const Vector3 normal = couch_from_camera.linear() * truth.laser_normal_in_camera;
    const double offset_m = truth.laser_distance_m + normal.dot(couch_from_camera.translation());
    for (int k = -8; k <= 0; ++k) {
      const double y = 0.05 * k;
      const Vector3 at((offset_m - normal.y() * y) / normal.x(), y, 0.0);
      const auto seen = seen_in_couch(truth, believed, at, yaw_rad);
      if (!seen) continue;
      const Vector3 place(1.0, seen->x(), seen->y());
      sums += place * place.transpose();
      sum += place * seen->z();
    }
  }
  const Vector3 plane = sums.inverse() * sum + Vector3(height_m, tilt_x, tilt_y);
  // Rotation by these angles about x and y levels z = plane(0) + plane(1) x + plane(2) y.
  Transform level = Transform::Identity();
  level.linear() = (Eigen::AngleAxisd(-std::atan(plane(2)), Vector3::UnitX()) *
                    Eigen::AngleAxisd(std::atan(plane(1)), Vector3::UnitY()))
                       .toRotationMatrix();
  level.translation().z() = -plane(0);
  believed.couch_from_camera = level * believed.couch_from_camera;

  const Vector3 mark_in_camera(
      truth.laser_distance_m / truth.laser_normal_in_camera.x() -
          reference_m * truth.laser_normal_in_camera.z() / truth.laser_normal_in_camera.x(),
      0.0, reference_m);
  const Vector3 mark = truth.couch_from_camera * mark_in_camera;
  if (const auto seen = seen_in_couch(truth, believed, mark, 0.0)) {
    // Viewed along y (sitting) the mark determines the heading, from above (prone) the position.
    const Vector3 eye = truth.couch_from_camera.translation();
    const double away_m = eye.y() - mark.y();
    Transform aside = Transform::Identity();
    if (std::abs(away_m) > 0.5) {
      const Eigen::AngleAxisd heading((seen->x() - mark.x()) / -away_m, Vector3::UnitZ());
      aside.linear() = heading.toRotationMatrix();
      aside.translation() = eye - aside.linear() * eye;
    } else {
      aside.translation().x() = mark.x() - seen->x();
    }
    believed.couch_from_camera = aside * believed.couch_from_camera;
  }
}

}  // namespace

ScannerMount usual_mount(BodyPosture position) {
  // 640 rows see from sacrum to C7 of people from 1.5 to 2 m at about 1.1 m. The back is near y = 0
  // (sitting) or z = 0.24 m (prone).
  return position == BodyPosture::sitting ? ScannerMount{.distance_m = 1.13, .along_spine_m = 0.41}
                                          : ScannerMount{.distance_m = 1.34, .along_spine_m = 0.34};
}

ScannerCalibration true_calibration(BodyPosture position, const ScannerMount& mount,
                                    double latency_s) {
  ScannerCalibration truth;
  CameraModel& camera = truth.camera;
  camera.width_px = mount.upright ? 480 : 640;
  camera.height_px = mount.upright ? 640 : 480;
  camera.fx_px = camera.fy_px = focal_px;
  camera.cx_px = 0.5 * (camera.width_px - 1);
  camera.cy_px = 0.5 * (camera.height_px - 1);
  truth.laser_normal_in_camera = {std::sin(lean_rad), 0.0, std::cos(lean_rad)};
  truth.laser_distance_m = baseline_m * std::sin(lean_rad);
  truth.axis_point_in_camera = {0.5 * baseline_m, 0.0, 0.0};
  truth.axis_direction_in_camera = -Vector3::UnitY();
  truth.latency_s = latency_s;

  // Behind a sitting person: camera x is minus couch x, y is down, z into the back. At yaw 0 the
  // line falls on the middle of the couch at 1.1 m.
  Matrix3 looking;
  looking << -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0;
  const double line_m = baseline_m - reference_m / std::tan(lean_rad) - 0.5 * baseline_m;
  const double turn_rad = std::atan2(line_m, reference_m);
  const Eigen::AngleAxisd turn(turn_rad, truth.axis_direction_in_camera);
  Transform couch_from_camera = Transform::Identity();
  couch_from_camera.linear() = looking * turn.toRotationMatrix();
  couch_from_camera.translation() = Vector3(0.0, mount.distance_m, mount.along_spine_m) -
                                    couch_from_camera.linear() * truth.axis_point_in_camera;
  if (position == BodyPosture::prone) {
    couch_from_camera = Eigen::AngleAxisd(90.0_deg, Vector3::UnitX()) * couch_from_camera;
  }
  truth.couch_from_camera = couch_from_camera;
  return truth;
}

ScannerCalibration believed_calibration(const ScannerCalibration& truth, std::uint64_t seed) {
  Random random = make_random(seed, "scanner calibration");
  ScannerCalibration believed = truth;
  CameraModel& camera = believed.camera;
  const double focal_error = gaussian(random, focal_error_px);
  camera.fx_px += focal_error;
  camera.fy_px += focal_error + gaussian(random, 0.2 * focal_error_px);
  camera.cx_px += gaussian(random, centre_error_px);
  camera.cy_px += gaussian(random, centre_error_px);
  camera.distortion[0] += gaussian(random, distortion_error);
  fit_laser_plane(truth, believed, random);

  const Vector3 axis = truth.axis_direction_in_camera;
  const Vector3 aside = axis.unitOrthogonal();
  const Vector3 other = axis.cross(aside);
  believed.axis_direction_in_camera =
      (axis + gaussian(random, axis_error_rad) * aside + gaussian(random, axis_error_rad) * other)
          .normalized();
  believed.axis_point_in_camera +=
      gaussian(random, axis_error_m) * aside + gaussian(random, axis_error_m) * other;
  believed.latency_s += gaussian(random, latency_error_s);

  place_on_couch(truth, believed, random);
  believed.errors = scanner::CalibrationErrors{.depth_m = {0.5, 1.0, 1.75},
                                               .range_m = {0.1e-3, 0.2e-3, 0.5e-3},
                                               .axis_direction_rad = axis_error_rad,
                                               .axis_point_m = axis_error_m,
                                               .latency_s = latency_error_s};
  return believed;
}

Mesh couch_mesh(BodyPosture position) {
  // A seat of 0.5 x 0.5 m under the hips, or a bed of 0.8 x 2 m.
  const double half_width_m = position == BodyPosture::sitting ? 0.25 : 0.4;
  const double from_m = position == BodyPosture::sitting ? -0.3 : -1.1;
  const double to_m = position == BodyPosture::sitting ? 0.2 : 0.9;
  Mesh mesh;
  mesh.vertices = {{-half_width_m, from_m, 0.0},
                   {half_width_m, from_m, 0.0},
                   {half_width_m, to_m, 0.0},
                   {-half_width_m, to_m, 0.0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace tuina::sim
