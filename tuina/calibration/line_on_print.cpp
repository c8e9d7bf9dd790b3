// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/line_on_print.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "tuina/core/random.hpp"

namespace tuina::calibration {
namespace {

using scanner::LinePoint;

constexpr double rim_squares = 0.8;  // the board ends one square beyond its inner corners
constexpr int tries = 200;
constexpr double along_line_px = 2.0;  // of a point from the line across the board, lens and all
constexpr std::size_t least_points = 12;
constexpr double window_widths = 4.0;
constexpr double least_height = 5.0;  // of the line, in standard deviations of it
constexpr double converged_px = 1e-3;
constexpr int clipped_dn = 254;  // the flanks of a line that is too bright tell its place as well
// What printed black adds to the light of the line, as a share of what white does beyond what it
// shows of the room's light. A camera with a black level, or a line as bright on black, need it.
constexpr std::array<double, 7> shares = {0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 100.0};
constexpr std::array<double, 8> width_factors = {0.5, 0.6, 0.7, 0.78, 0.86, 0.93, 1.08, 1.16};

// The four outer corners of the board, from its inner ones.
std::array<Vector2, 4> outline(std::span<const Vector2> corners, const Board& shape) {
  const auto at = [&](int x, int y) {
    return corners[static_cast<std::size_t>(y * shape.columns + x)];
  };
  const int right = shape.columns - 1;
  const int below = shape.rows - 1;
  const auto beyond = [&](int x, int y, int inner_x, int inner_y) -> Vector2 {
    const Vector2 corner = at(x, y);
    return corner + rim_squares * ((corner - at(inner_x, y)) + (corner - at(x, inner_y)));
  };
  return {beyond(0, 0, 1, 1), beyond(right, 0, right - 1, 1),
          beyond(right, below, right - 1, below - 1), beyond(0, below, 1, below - 1)};
}

bool inside(const std::array<Vector2, 4>& corners, const Vector2& at) {
  int left = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2 side = corners[(i + 1) % 4] - corners[i];
    const Vector2 to = at - corners[i];
    left += side.x() * to.y() - side.y() * to.x() > 0.0 ? 1 : -1;
  }
  return std::abs(left) == 4;
}

// A light plane meets a board in a straight line, which the lens bends a little.
struct Course {
  double middle_row = 0.0;
  Vector3 coefficients = Vector3::Zero();
  [[nodiscard]] double column_at(double row) const {
    const double y = (row - middle_row) / 100.0;
    return coefficients.dot(Vector3(1.0, y, y * y));
  }
};

Course fit_course(const std::vector<Vector2>& points) {
  Course course;
  for (const Vector2& point : points) course.middle_row += point.y();
  course.middle_row /= static_cast<double>(points.size());
  Matrix3 sums = Matrix3::Zero();
  sums(2, 2) = 1e-3 * static_cast<double>(points.size());
  Vector3 moments = Vector3::Zero();
  for (const Vector2& point : points) {
    const double y = (point.y() - course.middle_row) / 100.0;
    const Vector3 place(1.0, y, y * y);
    sums += place * place.transpose();
    moments += place * point.x();
  }
  course.coefficients = sums.ldlt().solve(moments);
  return course;
}

std::optional<Course> find_course(const std::vector<Vector2>& points) {
  if (points.size() < least_points) return std::nullopt;
  Random random = make_random(1, "line on print");
  const auto draw = [&] {
    const auto i =
        static_cast<std::size_t>(uniform(random, 0.0, 1.0) * static_cast<double>(points.size()));
    return points[std::min(i, points.size() - 1)];
  };
  std::vector<Vector2> best;
  for (int i = 0; i < tries; ++i) {
    const Vector2 a = draw();
    const Vector2 b = draw();
    if (std::abs(a.y() - b.y()) < 5.0) continue;
    const double slope = (b.x() - a.x()) / (b.y() - a.y());
    std::vector<Vector2> on;
    for (const Vector2& point : points) {
      if (std::abs(a.x() + slope * (point.y() - a.y()) - point.x()) < along_line_px) {
        on.push_back(point);
      }
    }
    if (on.size() > best.size()) best = std::move(on);
  }
  if (best.size() < least_points || best.size() < points.size() / 3) return std::nullopt;
  return fit_course(best);
}

class Fit {
 public:
  Fit(ImageView laser, ImageView board, double width_px, double noise_dn)
      : laser_(laser),
        board_(board),
        width_px_(width_px),
        window_px_(window_widths * width_px),
        noise_dn_(std::max(0.5, noise_dn)) {}

  // How the board without laser shows in the laser picture, which is darker: scale and offset, from
  // places beside the line.
  void learn_board(const Course& course, const std::array<Vector2, 4>& corners) {
    Eigen::Matrix2d sums = 1e-6 * Eigen::Matrix2d::Identity();
    Vector2 moments = Vector2::Zero();
    for (int row = 0; row < laser_.height; row += 2) {
      for (int column = 0; column < laser_.width; column += 3) {
        if (std::abs(column - course.column_at(row)) < 6.0 * width_px_) continue;
        if (!inside(corners, {column, row})) continue;
        const double shown = board_.row(row)[column];
        brightest_ = std::max(brightest_, shown);
        const Vector2 place(shown, 1.0);
        sums += place * place.transpose();
        moments += place * static_cast<double>(laser_.row(row)[column]);
      }
    }
    background_ = sums.ldlt().solve(moments);
  }

  void set_width(double width_px) { width_px_ = width_px; }
  [[nodiscard]] int rows() const { return laser_.height; }

  struct Row {
    double column_px = 0.0;
    double deviation_px = 0.0;
    double height_dn = 0.0;
    double misfit = 0.0;  ///< sum of squares of what is left, in units of the noise
  };

  // Gauss-Newton for place, height and a local offset of a Gaussian line on paper as bright as the
  // board shows it.
  [[nodiscard]] std::optional<Row> fit(int row, double column_px, double share) const {
    const double start_px = column_px;
    const int first = static_cast<int>(std::ceil(column_px - window_px_));
    const int last = static_cast<int>(std::floor(column_px + window_px_));
    if (first < 0 || last >= laser_.width) return std::nullopt;
    double height = 0.0;
    double offset = 0.0;
    for (int step = 0; step < 12; ++step) {
      Matrix3 sums = 1e-9 * Matrix3::Identity();
      Vector3 moments = Vector3::Zero();
      double misfit = 0.0;
      for (int x = first; x <= last; ++x) {
        if (laser_.row(row)[x] >= clipped_dn) continue;
        const double u = (x - column_px) / width_px_;
        const double shown = board_.row(row)[x];
        const double paper = (shown / brightest_ + share) / (1.0 + share);
        const double bell = paper * std::exp(-0.5 * u * u);
        const double seen = laser_.row(row)[x] - background_.x() * shown - background_.y();
        const double left = seen - height * bell - offset;
        const Vector3 slope(height * bell * u / width_px_, bell, 1.0);
        sums += slope * slope.transpose();
        moments += slope * left;
        misfit += left * left;
      }
      if (step == 0) sums(0, 0) += 1.0;  // no height yet, so the place stays
      const Vector3 change = sums.ldlt().solve(moments);
      height += change.y();
      offset += change.z();
      if (step > 0) {
        column_px += std::clamp(change.x(), -1.0, 1.0);
        if (std::abs(column_px - start_px) > along_line_px) return std::nullopt;
      }
      if (step > 1 && std::abs(change.x()) < converged_px) {
        const Matrix3 covariance = noise_dn_ * noise_dn_ * sums.inverse();
        if (!(height > least_height * std::sqrt(covariance(1, 1)))) return std::nullopt;
        return Row{.column_px = column_px,
                   .deviation_px = std::sqrt(covariance(0, 0)),
                   .height_dn = height,
                   .misfit = misfit / (noise_dn_ * noise_dn_)};
      }
    }
    return std::nullopt;
  }

 private:
  ImageView laser_;
  ImageView board_;
  double width_px_;
  double window_px_;  // the same for every width, so that what is left can be compared
  double noise_dn_;
  double brightest_ = 1.0;
  Vector2 background_ = Vector2::Zero();
};

struct FittedLine {
  std::vector<LinePoint> points;
  double misfit = 0.0;
};

FittedLine fit_rows(const Fit& fit, const Course& course, const std::array<Vector2, 4>& corners,
                    double share) {
  FittedLine line;
  for (int row = 0; row < fit.rows(); ++row) {
    const double column_px = course.column_at(row);
    if (!inside(corners, {column_px, row})) continue;
    const auto fitted = fit.fit(row, column_px, share);
    // A row that cannot be fitted leaves as much as three that can.
    line.misfit += fitted ? std::min(fitted->misfit, 200.0) : 100.0;
    if (!fitted) continue;
    line.points.push_back({.row = row,
                           .column_px = static_cast<float>(fitted->column_px),
                           .amplitude_dn = static_cast<float>(fitted->height_dn),
                           .deviation_px = static_cast<float>(fitted->deviation_px)});
  }
  return line;
}

}  // namespace

std::vector<LinePoint> line_on_print(ImageView laser, ImageView board,
                                     std::span<const Vector2> corners_px, const Board& shape,
                                     const scanner::LaserLine& found) {
  const auto corners = outline(corners_px, shape);
  std::vector<Vector2> on_board;
  for (const LinePoint& point : found.points) {
    const Vector2 at(static_cast<double>(point.column_px), point.row);
    if (inside(corners, at)) on_board.push_back(at);
  }
  const auto course = find_course(on_board);
  if (!course) return {};
  Fit fit(laser, board, std::max(1.0, found.width_px), found.noise_dn);
  fit.learn_board(*course, corners);
  // One share and one width for the whole board: those that leave least. A clipped line looks wider
  // than it is, so the width is tried as well.
  FittedLine best = fit_rows(fit, *course, corners, shares.front());
  double share = shares.front();
  for (const double other : shares) {
    FittedLine line = fit_rows(fit, *course, corners, other);
    if (line.misfit >= best.misfit) continue;
    share = other;
    best = std::move(line);
  }
  for (const double factor : width_factors) {
    fit.set_width(factor * std::max(1.0, found.width_px));
    FittedLine line = fit_rows(fit, *course, corners, share);
    if (line.misfit < best.misfit) best = std::move(line);
  }
  return best.points;
}

}  // namespace tuina::calibration
