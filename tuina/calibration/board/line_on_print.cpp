// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/board/line_on_print.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/random.hpp"

namespace tuina::calibration {
namespace {

using scanner::LinePoint;

constexpr int line_tries = 200;
// Distance of a point from the straight line across the board, lens included.
constexpr double along_line_px = 2.0;
constexpr std::size_t min_points = 12;
constexpr double window_widths = 4.0;
constexpr double min_height = 5.0;  // minimum height in standard deviations
constexpr double converged_px = 1e-3;
constexpr int clipped_dn = 254;  // the flanks of a clipped line still locate it
// Candidates of the light that printed black adds to the line, as a share of white's excess over
// the room light. Cameras with a black level, and lines as bright on black, need it.
constexpr std::array<double, 7> shares = {0.0, 0.05, 0.1, 0.25, 0.5, 1.0, 100.0};
constexpr std::array<double, 13> width_factors = {0.5,  0.6,  0.7,  0.78, 0.86, 0.93, 1.0,
                                                  1.08, 1.16, 1.35, 1.6,  2.0,  2.5};
constexpr int coarse_rows = 5;  // every fifth row is fitted to try share and width
// A larger share must reduce the residual at least to this fraction.
constexpr double surely = 0.97;
// Priors: along a board the line is even but for speckle, and beside it there is only the board.
// Without them a row with one flank on white would fit anywhere.
constexpr double even_height = 0.1;
constexpr double even_offset_dn = 3.0;

template <typename T>
double middle_of(std::vector<T>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
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

// Straight course of the line on a board, slightly bent by the lens.
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
  course.coefficients = solve_symmetric(sums, moments);
  return course;
}

std::optional<Course> find_course(const std::vector<Vector2>& points) {
  if (points.size() < min_points) return std::nullopt;
  Random random = make_random(1, "line on print");
  const auto draw = [&] {
    const auto i =
        static_cast<std::size_t>(uniform(random, 0.0, 1.0) * static_cast<double>(points.size()));
    return points[std::min(i, points.size() - 1)];
  };
  std::vector<Vector2> best;
  for (int i = 0; i < line_tries; ++i) {
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
  if (best.size() < min_points || best.size() < points.size() / 3) return std::nullopt;
  return fit_course(best);
}

// Appearance of the line: width, share of light added by printed black, and height along the rows.
struct LineModel {
  double share = 0.0;
  double width_px = 1.0;
  double height_dn = 0.0;  ///< at row 0; 0: unknown
  double height_dn_per_row = 0.0;
  [[nodiscard]] double height_at(int row) const { return height_dn + row * height_dn_per_row; }
};

class Fit {
 public:
  Fit(ImageView laser, ImageView board, double width_px, double noise_dn)
      : laser_(laser),
        board_(board),
        width_px_(width_px),
        window_px_(window_widths * width_px),
        noise_dn_(std::max(0.5, noise_dn)) {}

  // Fits scale and offset between the pictures without and with laser, from pixels beside the line.
  void fit_board(const Course& course, const std::array<Vector2, 4>& corners) {
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
    background_ = solve_symmetric(sums, moments);
    std::vector<int> steps;  // between neighbours, mostly within one square
    for (int row = 0; row < board_.height; row += 4) {
      for (int column = 1; column < board_.width; column += 2) {
        if (!inside(corners, {column, row})) continue;
        steps.push_back(std::abs(board_.row(row)[column] - board_.row(row)[column - 1]));
      }
    }
    // The median difference of two equal Gaussians is 0.95 standard deviations of one.
    if (!steps.empty()) board_noise_ = 1.05 * std::max(0.5, middle_of(steps)) / brightest_;
  }

  [[nodiscard]] int rows() const { return laser_.height; }

  struct Row {
    double column_px = 0.0;
    double deviation_px = 0.0;
    double height_dn = 0.0;
    double residual = 0.0;  ///< sum of squared residuals over the noise
  };

  // Gauss-Newton for position, height and local offset of a Gaussian line on paper of the
  // reflectance that the board picture shows.
  [[nodiscard]] std::optional<Row> fit(int row, double column_px, const LineModel& model) const {
    const double start_px = column_px;
    const int first = static_cast<int>(std::ceil(column_px - window_px_));
    const int last = static_cast<int>(std::floor(column_px + window_px_));
    if (first < 0 || last >= laser_.width) return std::nullopt;
    const double usual = model.height_at(row);
    double height = 0.0;
    double offset = 0.0;
    for (int step = 0; step < 12; ++step) {
      Matrix3 sums = 1e-9 * Matrix3::Identity();
      Vector3 moments = Vector3::Zero();
      double residual = 0.0;
      for (int x = first; x <= last; ++x) {
        if (laser_.row(row)[x] >= clipped_dn) continue;
        const double u = (x - column_px) / model.width_px;
        const double shown = board_.row(row)[x];
        const double paper = (shown / brightest_ + model.share) / (1.0 + model.share);
        const double bell = paper * std::exp(-0.5 * u * u);
        const double seen = laser_.row(row)[x] - background_.x() * shown - background_.y();
        const double left = seen - height * bell - offset;
        const Vector3 slope(height * bell * u / model.width_px, bell, 1.0);
        // Errors of the reflectance scale with the line's brightness.
        const double paper_noise =
            height * std::exp(-0.5 * u * u) * board_noise_ / (1.0 + model.share);
        const double weight = 1.0 / (1.0 + std::pow(paper_noise / noise_dn_, 2));
        sums += weight * slope * slope.transpose();
        moments += weight * slope * left;
        residual += weight * left * left - noise_dn_ * noise_dn_ * std::log(weight);
      }
      if (step == 0) sums(0, 0) += 1.0;  // the position is fixed while the height is unknown
      if (usual > 0.0) {
        const Vector2 weight(std::pow(noise_dn_ / (even_height * usual), 2),
                             std::pow(noise_dn_ / even_offset_dn, 2));
        sums(1, 1) += weight.x();
        sums(2, 2) += weight.y();
        moments.y() += weight.x() * (usual - height);
        moments.z() -= weight.y() * offset;
      }
      const Vector3 change = solve_symmetric(sums, moments);
      height += change.y();
      offset += change.z();
      if (step > 0) {
        column_px += std::clamp(change.x(), -1.0, 1.0);
        if (std::abs(column_px - start_px) > along_line_px) return std::nullopt;
      }
      if (step > 1 && std::abs(change.x()) < converged_px) {
        const Matrix3 covariance = noise_dn_ * noise_dn_ * sums.inverse();
        if (!(height > min_height * std::sqrt(covariance(1, 1)))) return std::nullopt;
        return Row{.column_px = column_px,
                   .deviation_px = std::sqrt(covariance(0, 0)),
                   .height_dn = height,
                   .residual = residual / (noise_dn_ * noise_dn_)};
      }
    }
    return std::nullopt;
  }

 private:
  ImageView laser_;
  ImageView board_;
  double width_px_;
  double window_px_;  // equal for all widths, so that residuals are comparable
  double noise_dn_;
  double brightest_ = 1.0;
  double board_noise_ = 0.0;  // share of its white
  Vector2 background_ = Vector2::Zero();
};

struct FittedLine {
  std::vector<LinePoint> points;
  double residual = 0.0;
};

FittedLine fit_rows(const Fit& fit, const Course& course, const std::array<Vector2, 4>& corners,
                    const LineModel& model, int step = 1) {
  FittedLine line;
  for (int row = 0; row < fit.rows(); row += step) {
    const double column_px = course.column_at(row);
    if (!inside(corners, {column_px, row})) continue;
    const auto fitted = fit.fit(row, column_px, model);
    // A row that cannot be fitted costs as much as three bad ones.
    line.residual += fitted ? std::min(fitted->residual, 200.0) : 100.0;
    if (!fitted) continue;
    line.points.push_back({.row = row,
                           .column_px = static_cast<float>(fitted->column_px),
                           .amplitude_dn = static_cast<float>(fitted->height_dn),
                           .deviation_px = static_cast<float>(fitted->deviation_px)});
  }
  return line;
}

// Height along the rows by the Theil-Sen estimator, robust against rows on black.
void fit_height(const std::vector<LinePoint>& points, LineModel& model) {
  if (points.size() < min_points) return;
  std::vector<double> slopes;
  const std::size_t apart = points.size() / 2;
  for (std::size_t i = 0; i + apart < points.size(); ++i) {
    const LinePoint& one = points[i];
    const LinePoint& other = points[i + apart];
    slopes.push_back(static_cast<double>(other.amplitude_dn - one.amplitude_dn) /
                     (other.row - one.row));
  }
  model.height_dn_per_row = middle_of(slopes);
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const LinePoint& point : points) {
    heights.push_back(static_cast<double>(point.amplitude_dn) -
                      model.height_dn_per_row * point.row);
  }
  model.height_dn = middle_of(heights);
}

// Refines one parameter to the vertex of a parabola through three residuals. Where only one flank
// of the line is on white, its position error equals that of the width.
template <typename Left>
void refine(const Left& left, LineModel& model, double LineModel::*what, double step) {
  const auto at = [&](double by) {
    LineModel tried = model;
    tried.*what += by;
    return left(tried, 1);
  };
  const double less = at(-step);
  const double middle = at(0.0);
  const double more = at(step);
  const double bend = less - 2.0 * middle + more;
  if (bend > 0.0) model.*what += std::clamp(0.5 * step * (less - more) / bend, -step, step);
}

}  // namespace

std::vector<LinePoint> line_on_print(ImageView laser, ImageView board,
                                     const std::array<Vector2, 4>& corners,
                                     const scanner::LaserLine& found) {
  std::vector<Vector2> on_board;
  for (const LinePoint& point : found.points) {
    const Vector2 at(static_cast<double>(point.column_px), point.row);
    if (inside(corners, at)) on_board.push_back(at);
  }
  const auto course = find_course(on_board);
  if (!course) return {};
  Fit fit(laser, board, std::max(1.0, found.width_px), found.noise_dn);
  fit.fit_board(*course, corners);
  // Grid search of one share and one width for the whole board; jointly, since a wrong width makes
  // a wrong share model right. A clipped line looks wider than it is.
  const auto left = [&](const LineModel& tried, int step) {
    return fit_rows(fit, *course, corners, tried, step).residual;
  };
  LineModel model;
  double least = std::numeric_limits<double>::infinity();
  for (const double share : shares) {
    for (const double factor : width_factors) {
      const LineModel tried{.share = share, .width_px = factor * std::max(1.0, found.width_px)};
      const double residual = left(tried, coarse_rows);
      // A dim line does not determine the share, so a smaller one is preferred.
      const double enough = share > model.share ? surely * least : least;
      if (residual >= enough) continue;
      least = residual;
      model = tried;
    }
  }
  for (int i = 0; i < 3; ++i) {
    refine(left, model, &LineModel::width_px, 0.05 * model.width_px);
    refine(left, model, &LineModel::share, 0.02 * (1.0 + model.share));
  }
  fit_height(fit_rows(fit, *course, corners, model).points, model);
  return fit_rows(fit, *course, corners, model).points;
}

}  // namespace tuina::calibration
