// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/couch.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::calibration {
namespace {

constexpr double in_board_m = 2.0_mm;  // at 1 m; a board is flat, the line is noisy
constexpr double flat_m = 3.0_mm;
constexpr double min_share = 0.25;  // share of all points; the rest is the couch beside the board
constexpr std::size_t min_places = 2000;
constexpr int tries = 300;
constexpr double off_nominal_rad = 30.0_deg;
constexpr double alike_share = 0.03;  // by which two lengths may differ that are wrong by one cause
constexpr double off_nominal_share = 0.25;  // share of a length: a wrong square is off by more

struct Plane {
  Vector3 normal = Vector3::UnitZ();  // towards the camera
  double distance_m = 0.0;            // distance of the camera from the plane
  std::size_t points = 0;
  double rms_m = 0.0;
  double spread_m = 0.0;  // RMS radius of the points along the short axis
};

// Points of the sweep in the camera frame at yaw 0.
Result<std::vector<Vector3>> points_of(const Sweep& sweep,
                                       const scanner::ScannerCalibration& measured) {
  std::vector<double> times_s;
  times_s.reserve(sweep.lines.size());
  for (const auto& line : sweep.lines) times_s.push_back(line.time_s);
  const auto yaw = scanner::yaw_at(times_s, sweep.readings, measured.latency_s);
  if (!yaw) return tl::unexpected(yaw.error());
  scanner::ScannerCalibration in_camera = measured;
  in_camera.couch_from_camera = Transform::Identity();
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < sweep.lines.size(); ++i) {
    const Transform turned = in_camera.couch_from_camera_at((*yaw)[i]);
    for (const auto& seen : sweep.lines[i].line.points) {
      if (seen.row % 4 != 0) continue;
      const auto point =
          scanner::triangulate(measured, static_cast<double>(seen.column_px), seen.row);
      if (point) points.push_back(turned * *point);
    }
  }
  return points;
}

// Distance from the plane relative to the noise at that range.
double off(const Plane& plane, const Vector3& point) {
  const double off_m = std::abs(plane.normal.dot(point) + plane.distance_m);
  return off_m / (in_board_m * std::max(1.0, point.squaredNorm()));
}

Plane plane_through(const std::vector<Vector3>& points) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& point : points) middle += point;
  middle /= static_cast<double>(points.size());
  Matrix3 spread = Matrix3::Zero();
  for (const Vector3& point : points) spread += (point - middle) * (point - middle).transpose();
  spread /= static_cast<double>(points.size());
  const PrincipalAxes principal = principal_axes(spread);
  Plane plane{.normal = principal.axes.col(0), .points = points.size()};
  if (plane.normal.dot(middle) > 0.0) plane.normal = -plane.normal;
  plane.distance_m = -plane.normal.dot(middle);
  plane.rms_m = std::sqrt(std::max(0.0, principal.moments(0)));
  plane.spread_m = std::sqrt(principal.moments(1));
  return plane;
}

std::vector<Vector3> inside(const Plane& plane, const std::vector<Vector3>& points, bool wanted) {
  std::vector<Vector3> chosen;
  for (const Vector3& point : points) {
    if ((off(plane, point) < 1.0) == wanted) chosen.push_back(point);
  }
  return chosen;
}

// The plane with most points (RANSAC).
Plane largest_plane(const std::vector<Vector3>& points) {
  Random random = make_random(1, "couch board");
  const auto draw = [&] {
    const auto i =
        static_cast<std::size_t>(uniform(random, 0.0, 1.0) * static_cast<double>(points.size()));
    return points[std::min(i, points.size() - 1)];
  };
  Plane best;
  double most = 0.0;
  for (int i = 0; i < tries; ++i) {
    const Plane plane = plane_through({draw(), draw(), draw()});
    // Near points weigh more, else a skew plane through board and couch would win.
    double in = 0.0;
    for (std::size_t k = 0; k < points.size(); k += 7) {
      in += std::max(0.0, 1.0 - off(plane, points[k]));
    }
    if (in > most) {
      most = in;
      best = plane;
    }
  }
  for (int i = 0; i < 4; ++i) {
    const auto in = inside(best, points, true);
    if (in.size() < 3) break;
    best = plane_through(in);
  }
  return best;
}

// The board lies on the couch: the nearer of two large parallel planes.
Plane find_board(const std::vector<Vector3>& points) {
  Plane first = largest_plane(points);
  const auto rest = inside(first, points, false);
  if (static_cast<double>(rest.size()) > min_share * static_cast<double>(points.size())) {
    Plane second = largest_plane(rest);
    const bool parallel = second.normal.dot(first.normal) > std::cos(5.0_deg);
    const bool large =
        static_cast<double>(second.points) > min_share * static_cast<double>(points.size());
    if (parallel && large && second.distance_m < first.distance_m) return second;
  }
  return first;
}

Result<void> check_against_nominal(const scanner::ScannerCalibration& nominal,
                                   const scanner::ScannerCalibration& measured,
                                   const Plane& board) {
  const double light = std::abs(measured.laser_distance_m / nominal.laser_distance_m);
  const double height = board.distance_m / std::abs(nominal.couch_from_camera.translation().z());
  const auto wrong = [](double ratio) {
    return ratio > 1.0 + off_nominal_share || ratio < 1.0 - off_nominal_share;
  };
  // A scanner is seldom built larger or smaller by the same share in all, and never seems so by
  // chance.
  const bool alike = std::abs(light / height - 1.0) < alike_share &&
                     std::abs(height - 1.0) > 0.5 * off_nominal_share;
  if (alike || (wrong(light) && wrong(height))) {
    return fail(Fault::bad_input,
                "all is {:.2f} times as large as the nominal calibration in couch/ says: is "
                "square_m in board.toml right?",
                height);
  }
  const Vector3 up = nominal.couch_from_camera.linear().transpose() * Vector3::UnitZ();
  const double tilted_rad = std::acos(std::clamp(up.dot(board.normal), -1.0, 1.0));
  if (tilted_rad > off_nominal_rad) {
    return fail(Fault::bad_input,
                "the board on the couch is tilted by {:.0f} deg from what the nominal calibration "
                "in couch/ says",
                to_deg(tilted_rad));
  }
  return {};
}

}  // namespace

Result<CouchPose> find_couch(const Sweep& sweep, const scanner::ScannerCalibration& measured) {
  const auto points = points_of(sweep, measured);
  if (!points) return tl::unexpected(points.error());
  if (points->size() < min_places / 4) {
    return fail(Fault::bad_input, "the sweep over the couch has {} points, {} needed",
                points->size(), min_places / 4);
  }
  const Plane board = find_board(*points);
  const auto share = static_cast<double>(board.points) / static_cast<double>(points->size());
  if (const auto good = check_against_nominal(sweep.nominal, measured, board); !good) {
    return tl::unexpected(good.error());
  }
  if (share < min_share || board.rms_m > flat_m) {
    return fail(Fault::bad_input,
                "the board on the couch does not come out flat: {:.0f} % of the points lie within "
                "{:.1f} mm of a plane; is it bare and still, and does the yaw have the right sign?",
                100.0 * share, to_mm(in_board_m));
  }

  CouchPose pose;
  pose.flatness_m = board.rms_m;
  const Transform& nominal = sweep.nominal.couch_from_camera;
  const Vector3 up = nominal.linear().transpose() * Vector3::UnitZ();
  // The smallest rotation from the measured to the nominal normal keeps the heading.
  const auto level = turn_between(board.normal, up);
  pose.couch_from_camera.linear() = nominal.linear() * level.toRotationMatrix();
  pose.couch_from_camera.translation() =
      Vector3(nominal.translation().x(), nominal.translation().y(), board.distance_m);
  // Errors within one line correlate, so each profile counts once.
  const double profiles = std::max<double>(1.0, static_cast<double>(sweep.lines.size()));
  pose.height_deviation_m = board.rms_m / std::sqrt(profiles);
  pose.tilt_deviation_rad = pose.height_deviation_m / std::max(0.01, board.spread_m);
  return pose;
}

Transform couch_not_measured(const scanner::ScannerCalibration& measured) {
  const Vector3 up = measured.axis_direction_in_camera.y() < 0.0
                         ? measured.axis_direction_in_camera
                         : Vector3(-measured.axis_direction_in_camera);
  const Vector3 ahead = (Vector3::UnitZ() - up.z() * up).normalized();
  Transform couch_from_camera = Transform::Identity();
  // Rows: x to the left of the camera, y behind it, z up.
  couch_from_camera.linear().row(1) = -ahead.transpose();
  couch_from_camera.linear().row(2) = up.transpose();
  couch_from_camera.linear().row(0) = (-ahead).cross(up).transpose();
  couch_from_camera.translation() = -(couch_from_camera.linear() * measured.axis_point_in_camera);
  return couch_from_camera;
}

}  // namespace tuina::calibration
