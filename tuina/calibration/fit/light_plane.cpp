// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/light_plane.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::calibration {
namespace {

constexpr int plane_tries = 400;
// Distance of the line from the plane at 1 m, growing with the square of the range, that a few
// tenths of a pixel of corner and line noise cause before the joint fit.
constexpr double in_plane_m = 5.0_mm;
constexpr double tolerated_share = 0.1;  // share of outlier poses; `lines_off` names them
constexpr double nearest_camera_m = 15.0_mm;

using Line = std::vector<LineOnBoard>;

double allowed_m(const Vector3& at) {
  return in_plane_m * std::max(0.5, at.z() * at.z());
}

double off_m(const LightPlane& plane, const Vector3& at) {
  return std::abs(plane.normal.dot(at) - plane.distance_m);
}

// Median distance of one pose's points from the plane, relative to the tolerance.
double median_off(const LightPlane& plane, const Line& line, const Vector3& flip) {
  std::vector<double> off;
  for (const LineOnBoard& point : line) {
    const Vector3 at = point.at_in_camera.cwiseProduct(flip);
    off.push_back(off_m(plane, at) / allowed_m(at));
  }
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return *middle;
}

bool fits(const LightPlane& plane, const Line& line, const Vector3& flip = Vector3::Ones()) {
  return line.size() >= min_line_points && median_off(plane, line, flip) < 1.0;
}

// Total least squares, near points weighted more for their smaller error.
LightPlane through(const std::vector<Vector3>& points) {
  Vector3 middle = Vector3::Zero();
  double weights = 0.0;
  for (const Vector3& point : points) {
    const double weight = std::pow(point.z(), -4);
    middle += weight * point;
    weights += weight;
  }
  middle /= weights;
  Matrix3 spread = Matrix3::Zero();
  for (const Vector3& point : points) {
    spread += std::pow(point.z(), -4) * (point - middle) * (point - middle).transpose();
  }
  const PrincipalAxes principal = principal_axes(spread);
  LightPlane plane{.normal = principal.axes.col(0)};
  plane.distance_m = plane.normal.dot(middle);
  if (plane.normal.x() < 0.0) plane = {.normal = -plane.normal, .distance_m = -plane.distance_m};
  return plane;
}

// The plane most poses agree on (RANSAC: two points of one board, one of another).
LightPlane agreed_on(const std::vector<Line>& lines) {
  std::vector<const Line*> lit;
  for (const Line& line : lines) {
    if (line.size() >= min_line_points) lit.push_back(&line);
  }
  Random random = make_random(1, "light plane");  // fixed seed, for repeatable results
  const auto draw = [&](std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(uniform(random, 0.0, 1.0) *
                                                        static_cast<double>(count)));
  };
  LightPlane best;
  double most = -1.0;
  for (int i = 0; i < plane_tries; ++i) {
    const Line& one = *lit[draw(lit.size())];
    const Line& other = *lit[draw(lit.size())];
    const LightPlane plane =
        through({one[draw(one.size())].at_in_camera, one[draw(one.size())].at_in_camera,
                 other[draw(other.size())].at_in_camera});
    double score = 0.0;
    for (const Line* line : lit) {
      score += std::max(0.0, 1.0 - median_off(plane, *line, Vector3::Ones()));
    }
    if (score > most) {
      most = score;
      best = plane;
    }
  }
  for (int i = 0; i < 5; ++i) {
    std::vector<Vector3> inside;
    for (const Line* line : lit) {
      if (!fits(best, *line)) continue;
      for (const LineOnBoard& point : *line) {
        if (off_m(best, point.at_in_camera) < allowed_m(point.at_in_camera)) {
          inside.push_back(point.at_in_camera);
        }
      }
    }
    if (inside.size() >= 3) best = through(inside);
  }
  return best;
}

// A mirrored picture: columns count from the other side.
View mirrored(View view, int width_px, bool corners, bool line) {
  if (corners) {
    for (Vector2& corner : view.corners_px) corner.x() = width_px - 1 - corner.x();
  }
  if (line) {
    for (auto& point : view.line) {
      point.column_px = static_cast<float>(width_px - 1) - point.column_px;
    }
  }
  return view;
}

// Pose of a mirrored board; its own x then runs the other way.
Transform mirrored(const Transform& camera_from_board) {
  const Vector3 flip(-1.0, 1.0, 1.0);
  Transform result = Transform::Identity();
  result.linear() = flip.asDiagonal() * camera_from_board.linear() *
                    Vector3(1.0, 1.0, -1.0).asDiagonal().toDenseMatrix();
  result.translation() = flip.asDiagonal() * camera_from_board.translation();
  return result;
}

bool fits_mirrored(const LightPlane& plane, const Views& views, std::size_t i,
                   const scanner::CameraModel& camera, const Transform& camera_from_board) {
  for (const auto& [corners, line] : {std::pair{true, true}, {true, false}, {false, true}}) {
    const Transform pose = corners ? mirrored(camera_from_board) : camera_from_board;
    if (fits(plane, line_on_board(mirrored(views.views[i], views.width_px, corners, line),
                                  views.board, camera, pose))) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<LineOnBoard> line_on_board(const View& view, const Board& board,
                                       const scanner::CameraModel& camera,
                                       const Transform& camera_from_board) {
  const Transform board_from_camera = camera_from_board.inverse();
  const Vector3 eye = board_from_camera.translation();
  const auto place = [&](double column_px, double row_px) -> Vector2 {
    const Vector3 ray =
        board_from_camera.linear() * scanner::ray_through(camera, column_px, row_px);
    return (eye - ray * (eye.z() / ray.z())).head<2>() / board.square_m;
  };
  std::vector<LineOnBoard> line;
  for (const scanner::LinePoint& seen : view.line) {
    const auto column = static_cast<double>(seen.column_px);
    const Vector2 at = place(column, seen.row);
    const bool inside = at.x() > -rim_squares && at.x() < board.columns - 1 + rim_squares &&
                        at.y() > -rim_squares && at.y() < board.rows - 1 + rim_squares;
    if (!inside) continue;
    const Vector3 on_board(at.x() * board.square_m, at.y() * board.square_m, 0.0);
    line.push_back({.column_px = column,
                    .row_px = static_cast<double>(seen.row),
                    .deviation_px = static_cast<double>(seen.deviation_px),
                    .at_in_camera = camera_from_board * on_board});
  }
  return line;
}

Result<LightPlane> find_light_plane(const Views& views, const scanner::CameraModel& camera,
                                    const std::vector<Transform>& camera_from_board) {
  std::vector<Line> lines;
  std::size_t lit = 0;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    lines.push_back(line_on_board(views.views[i], views.board, camera, camera_from_board[i]));
    lit += lines.back().size() >= min_line_points ? 1U : 0U;
  }
  if (lit < 3) {
    return fail(Fault::bad_input,
                "the laser line is seen on the board in {} poses; is the laser on, and does it "
                "cross the board?",
                lit);
  }
  LightPlane plane = agreed_on(lines);

  std::vector<std::string> off;
  std::vector<std::string> mirrored_poses;
  std::vector<std::string> swapped;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!views.views[i].laser_on || fits(plane, lines[i])) continue;
    const View& view = views.views[i];
    if (fits_mirrored(plane, views, i, camera, camera_from_board[i])) {
      mirrored_poses.push_back(std::to_string(view.pose));
    }
    for (std::size_t k = 0; k < lines.size(); ++k) {
      // Line of this pose on the board of another: swapped pictures?
      if (k == i || !views.views[k].laser_on || fits(plane, lines[k])) continue;
      if (fits(plane, line_on_board(view, views.board, camera, camera_from_board[k]))) {
        swapped.push_back(fmt::format("{} (fits {})", view.pose, views.views[k].pose));
        break;
      }
    }
    if (lines[i].size() >= min_line_points) off.push_back(std::to_string(view.pose));
  }
  if (!swapped.empty() && swapped.size() >= mirrored_poses.size()) {
    return fail(Fault::bad_input,
                "laser pictures are swapped between poses: that of pose {} shows the line as "
                "another board would have it; correct frames.csv",
                listed(swapped));
  }
  if (!mirrored_poses.empty()) {
    return fail(Fault::bad_input,
                "some pictures are mirrored and some are not: the line in pose {} fits the others "
                "only when left and right are exchanged; switch mirroring off in the camera",
                listed(mirrored_poses));
  }
  if (static_cast<double>(off.size()) > tolerated_share * static_cast<double>(lit)) {
    return fail(Fault::bad_input,
                "in {} of {} poses ({}) the laser line does not lie in one plane with the others: "
                "did board, laser or camera move between the two pictures of a pose?",
                off.size(), lit, listed(off));
  }
  if (std::abs(plane.distance_m) < nearest_camera_m) {
    return fail(Fault::bad_input,
                "the light plane passes the camera at {:.1f} mm, almost through it: range cannot "
                "be told then; mount the laser aside, 50 mm at least",
                to_mm(std::abs(plane.distance_m)));
  }
  return plane;
}

std::vector<LineOff> lines_off(const LightPlane& plane, const Views& views,
                               const scanner::CameraModel& camera,
                               const std::vector<Transform>& camera_from_board) {
  std::vector<LineOff> found;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const Line line = line_on_board(views.views[i], views.board, camera, camera_from_board[i]);
    if (line.size() < min_line_points || fits(plane, line)) continue;
    std::vector<double> off;
    off.reserve(line.size());
    for (const LineOnBoard& point : line) off.push_back(off_m(plane, point.at_in_camera));
    std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2),
                     off.end());
    found.push_back({.view = i, .off_m = off[off.size() / 2]});
  }
  return found;
}

}  // namespace tuina::calibration
