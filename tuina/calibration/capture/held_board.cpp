// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/capture/held_board.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "tuina/core/units.hpp"

namespace tuina::calibration {
namespace {

// Focal length over the longer side of the picture, of webcams and of cameras for machines, and
// what it weighs against a board that is tilted by 30 degrees, which weighs 0.1.
constexpr double usual_focal_share = 1.2;
constexpr double usual_weight = 1e-3;

constexpr std::array<double, 4> bands_m = {0.4, 0.75, 1.15, 1.9};
constexpr std::array<const char*, 3> band_words = {"0.6 m", "0.9 m", "1.4 m"};
// Far side to the right, down, to the left, up.
constexpr std::array<const char*, 4> far_words = {"its right side", "its lower side",
                                                  "its left side", "its upper side"};
// Below, a tilt tells nothing of the focal length; beyond, squares become too narrow.
constexpr double min_tilt_rad = 15.0_deg, max_tilt_rad = 50.0_deg;
constexpr double min_contrast_dn = 40.0, max_blur_px = 4.0;

/// Map from the board's plane, in metres, to the picture, in pixels about its middle, from a null
/// space [zhang2000, appendix A].
Matrix3 homography(const SeenBoard& seen, const Board& board, const Vector2& middle_px) {
  const double square = board.square_m;
  Eigen::Matrix<double, Eigen::Dynamic, 9> rows(
      2 * static_cast<Eigen::Index>(seen.corners_px.size()), 9);
  const double scale_px = middle_px.norm();
  for (std::size_t k = 0; k < seen.corners_px.size(); ++k) {
    const int corner = seen.which.empty() ? static_cast<int>(k) : seen.which[k];
    const int column = corner % board.columns, line = corner / board.columns;
    const Vector3 at(column, line, 1.0);  // in squares
    const Vector2 to = (seen.corners_px[k] - middle_px) / scale_px;
    const auto row = 2 * static_cast<Eigen::Index>(k);
    rows.row(row) << at.transpose(), 0.0, 0.0, 0.0, -to.x() * at.transpose();
    rows.row(row + 1) << 0.0, 0.0, 0.0, at.transpose(), -to.y() * at.transpose();
  }
  const Eigen::Matrix<double, 9, 1> found =
      Eigen::JacobiSVD<Eigen::Matrix<double, 9, 9>>(rows.transpose() * rows, Eigen::ComputeFullV)
          .matrixV()
          .col(8);
  Matrix3 map;
  map << found.segment<3>(0).transpose(), found.segment<3>(3).transpose(),
      found.segment<3>(6).transpose();
  map.topRows<2>() *= scale_px;
  map.leftCols<2>() /= square;
  return map;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

int band_of(double distance_m) {
  const auto above = std::upper_bound(bands_m.begin(), bands_m.end(), distance_m);
  return static_cast<int>(above - bands_m.begin()) - 1;  // -1 or 3: beyond all
}

int kind_of(const HeldBoard& board) {
  const double quarter = std::numbers::pi / 2.0;
  const int far = (static_cast<int>(std::lround(board.far_side_rad / quarter)) + 4) % 4;
  return 4 * band_of(board.distance_m) + far;
}

std::string words_of(int kind) {
  return fmt::format("about {} away, {} tilted away from the scanner by 20 to 40 degrees",
                     band_words[static_cast<std::size_t>(kind / 4)],
                     far_words[static_cast<std::size_t>(kind % 4)]);
}

}  // namespace

FocalGuess::FocalGuess(int width_px, int height_px)
    : middle_px_(0.5 * width_px, 0.5 * height_px),
      usual_px_(usual_focal_share * std::max(width_px, height_px)),
      slopes_(usual_weight),
      values_(usual_weight) {}

// Both columns of a homography without its camera are of one length and at a right angle; each of
// these tells w = (usual / focal)^2 by a w + b = 0.
void FocalGuess::see(const SeenBoard& seen, const Board& board) {
  Matrix3 map = homography(seen, board, middle_px_);
  map.topRows<2>() /= usual_px_;
  map /= std::sqrt(0.5 * map.leftCols<2>().squaredNorm());
  const Vector2 x = map.block<2, 1>(0, 0), y = map.block<2, 1>(0, 1);
  const std::array<std::array<double, 2>, 2> equations = {
      {{x.dot(y), map(2, 0) * map(2, 1)},
       {x.squaredNorm() - y.squaredNorm(), map(2, 0) * map(2, 0) - map(2, 1) * map(2, 1)}}};
  for (const auto& [a, b] : equations) {
    slopes_ += a * a;
    values_ -= a * b;
  }
}

double FocalGuess::focal_px() const {
  constexpr double max_off = 4.0;  // wider than any lens
  const double w = std::clamp(values_ / slopes_, 1.0 / (max_off * max_off), max_off * max_off);
  return usual_px_ / std::sqrt(w);
}

HeldBoard look_at_board(const SeenBoard& seen, ImageView image, const Board& board,
                        const FocalGuess& camera) {
  const double focal_px = camera.focal_px();
  Matrix3 map = homography(seen, board, camera.middle_px());
  map.topRows<2>() /= focal_px;
  map /= std::sqrt(map.col(0).norm() * map.col(1).norm());
  if (map(2, 2) < 0.0) map = -map;
  const Vector3 x = map.col(0).normalized(), y = map.col(1).normalized();
  Vector3 normal = x.cross(y).normalized();
  if (normal.z() < 0.0) normal = -normal;

  HeldBoard held;
  // Of the middle of the board, not of its first corner.
  held.distance_m = (map * Vector3(0.5 * (board.columns - 1) * board.square_m,
                                   0.5 * (board.rows - 1) * board.square_m, 1.0))
                        .norm();
  // The plane's depth grows against the sideways part of its normal.
  held.tilt_rad = std::acos(std::clamp(normal.z(), -1.0, 1.0));
  held.far_side_rad = std::atan2(-normal.y(), -normal.x());

  // Around a corner two white and two black squares meet: the steepest step between two pixels,
  // against the step from white to black, is how sharp the picture is.
  std::vector<double> blurs, contrasts;
  const double per_corner_px =
      held.distance_m > 0.0 ? focal_px * board.square_m / held.distance_m : 0.0;
  const int reach = std::max(3, static_cast<int>(0.4 * per_corner_px));
  for (const Vector2& corner : seen.corners_px) {
    const int x0 = static_cast<int>(corner.x()), y0 = static_cast<int>(corner.y());
    if (x0 < reach || y0 < reach || x0 + reach >= image.width || y0 + reach >= image.height)
      continue;
    int low = 255, high = 0;
    double steepest = 0.0;
    for (int row = y0 - reach + 1; row < y0 + reach; ++row) {
      for (int column = x0 - reach + 1; column < x0 + reach; ++column) {
        const int here = image.row(row)[column];
        low = std::min(low, here), high = std::max(high, here);
        const double along = image.row(row)[column + 1] - here;
        const double down = image.row(row + 1)[column] - here;
        steepest = std::max(steepest, std::hypot(along, down));
      }
    }
    contrasts.push_back(high - low);
    blurs.push_back(steepest > 0.0 ? (high - low) / steepest : std::numeric_limits<double>::max());
  }
  held.contrast_dn = median_of(contrasts);
  held.blur_px = median_of(blurs);
  return held;
}

double moved_px(const SeenBoard& one, const SeenBoard& other) {
  double sum = 0.0;
  int shared = 0;
  for (std::size_t k = 0; k < one.corners_px.size(); ++k) {
    std::size_t at = k;
    if (!one.which.empty()) {
      const auto same = std::find(other.which.begin(), other.which.end(), one.which[k]);
      at = static_cast<std::size_t>(same - other.which.begin());
    }
    if (at >= other.corners_px.size()) continue;
    sum += (one.corners_px[k] - other.corners_px[at]).squaredNorm();
    ++shared;
  }
  return shared > 0 ? std::sqrt(sum / shared) : std::numeric_limits<double>::infinity();
}

std::string WantedPoses::judge(const HeldBoard& board) const {
  if (board.contrast_dn < min_contrast_dn)
    return fmt::format("black and white differ by {:.0f} DN: more light, or a longer exposure",
                       board.contrast_dn);
  if (board.blur_px > max_blur_px)
    return fmt::format("edges are {:.1f} px wide: focus the camera", board.blur_px);
  if (board.distance_m < bands_m.front()) return "too near";
  if (board.distance_m >= bands_m.back()) return "too far away";
  if (board.tilt_rad < min_tilt_rad)
    return fmt::format("tilted by {:.0f} degrees only", to_deg(board.tilt_rad));
  if (board.tilt_rad > max_tilt_rad)
    return fmt::format("tilted by {:.0f} degrees, too far", to_deg(board.tilt_rad));
  if (kept_[static_cast<std::size_t>(kind_of(board))] >= of_each_) return "such a pose is there";
  return {};
}

void WantedPoses::keep(const HeldBoard& board) {
  ++kept_[static_cast<std::size_t>(kind_of(board))];
}

int WantedPoses::kept() const {
  return std::accumulate(kept_.begin(), kept_.end(), 0);
}

std::string WantedPoses::next() const {
  const auto fewest = std::min_element(kept_.begin(), kept_.end());
  if (*fewest >= of_each_) return {};
  return words_of(static_cast<int>(fewest - kept_.begin()));
}

}  // namespace tuina::calibration
