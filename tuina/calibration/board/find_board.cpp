// SPDX-License-Identifier: Apache-2.0
// Only this file and find_charuco.cpp use OpenCV.
#include "tuina/calibration/board/find_board.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tuina/calibration/board/find_charuco.hpp"
#include "tuina/calibration/board/refine_corner.hpp"
#include "tuina/core/grid.hpp"

namespace tuina::calibration {
namespace {

// The refinement window must not reach neighbouring corners.
constexpr double window_per_square = 0.4;
constexpr int min_window_px = 2;
constexpr int max_window_px = 9;

double min_side_px(const std::vector<cv::Point2f>& corners, const Board& board) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int y = 0; y < board.rows; ++y) {
    for (int x = 0; x < board.columns; ++x) {
      const auto i = grid_index(y, board.columns, x);
      if (x > 0) shortest = std::min(shortest, cv::norm(corners[i] - corners[i - 1]));
      if (y > 0) {
        const auto above = i - static_cast<std::size_t>(board.columns);
        shortest = std::min(shortest, cv::norm(corners[i] - corners[above]));
      }
    }
  }
  return shortest;
}

std::vector<cv::Point3f> places_of(const View& view, const Board& board) {
  std::vector<cv::Point3f> points;
  for (std::size_t k = 0; k < view.corners_px.size(); ++k) {
    const Vector3 at = corner_on(board, view.corner(k));
    points.emplace_back(static_cast<float>(at.x()), static_cast<float>(at.y()), 0.0F);
  }
  return points;
}

// Outer corners of the board, extrapolated from its inner ones.
std::array<Vector2, 4> outline(const std::vector<Vector2>& corners, const Board& board) {
  const auto at = [&](int x, int y) { return corners[grid_index(y, board.columns, x)]; };
  const int right = board.columns - 1;
  const int below = board.rows - 1;
  const auto beyond = [&](int x, int y, int inner_x, int inner_y) -> Vector2 {
    const Vector2 corner = at(x, y);
    return corner + rim_squares * ((corner - at(inner_x, y)) + (corner - at(x, inner_y)));
  };
  return {beyond(0, 0, 1, 1), beyond(right, 0, right - 1, 1),
          beyond(right, below, right - 1, below - 1), beyond(0, below, 1, below - 1)};
}

/// Rounds a start value. The last digits of OpenCV depend on memory addresses, through its BLAS;
/// rounded, the same pictures give the same results.
double coarse(double value, double step) {
  return step * std::round(value / step);
}

Transform transform_of(const cv::Mat& rotation, const cv::Mat& translation) {
  const auto vector = [](const cv::Mat& m) {
    constexpr double step = 0x1p-16;  // radians and metres
    return Vector3(coarse(m.at<double>(0), step), coarse(m.at<double>(1), step),
                   coarse(m.at<double>(2), step));
  };
  const Vector3 turn = vector(rotation);
  Transform transform = Transform::Identity();
  if (const double angle = turn.norm(); angle > 0.0) {
    transform.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  transform.translation() = vector(translation);
  return transform;
}

}  // namespace

std::optional<SeenBoard> find_board(ImageView image, const Board& board, Effort effort) {
  if (board.has_markers()) return find_charuco(image, board);
  const cv::Mat grey(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  const cv::Size pattern(board.columns, board.rows);
  std::vector<cv::Point2f> corners;
  int window = 0;
  try {
    constexpr int quick = cv::CALIB_CB_NORMALIZE_IMAGE;
    constexpr int thorough = quick | cv::CALIB_CB_EXHAUSTIVE;
    if (!cv::findChessboardCornersSB(grey, pattern, corners, quick) &&
        (effort == Effort::quick ||
         !cv::findChessboardCornersSB(grey, pattern, corners, thorough))) {
      return std::nullopt;
    }
    // The corners of findChessboardCornersSB (OpenCV 4.6) are off by 0.01 to 0.03 px even in clean
    // pictures, which costs pixels of focal length, so they are refined by gradients.
    window = std::clamp(static_cast<int>(window_per_square * min_side_px(corners, board)),
                        min_window_px, max_window_px);
    cv::cornerSubPix(grey, corners, {window, window}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4});
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  SeenBoard found;
  for (const cv::Point2f& corner : corners) {
    const Vector2 near(corner.x, corner.y);
    found.corners_px.push_back(refine_corner(image, near, window).value_or(near));
  }
  found.outline_px = outline(found.corners_px, board);
  return found;
}

Result<FirstCamera> calibrate_camera(const Views& views) {
  std::vector<std::vector<cv::Point3f>> boards;
  std::vector<std::vector<cv::Point2f>> pictures;
  for (const View& view : views.views) {
    boards.push_back(places_of(view, views.board));
    auto& corners = pictures.emplace_back();
    for (const Vector2& corner : view.corners_px) {
      corners.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
    }
  }
  cv::Mat matrix;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  try {
    // Without distortion here; the joint fit estimates it with its prior.
    cv::calibrateCamera(boards, pictures, {views.width_px, views.height_px}, matrix, distortion,
                        rotations, translations,
                        cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST);
  } catch (const cv::Exception& error) {
    return fail(Fault::bad_input, "the camera cannot be calibrated from these boards: {}",
                error.err);
  }
  FirstCamera first;
  first.camera = {.width_px = views.width_px,
                  .height_px = views.height_px,
                  .fx_px = coarse(matrix.at<double>(0, 0), 0x1p-8),
                  .fy_px = coarse(matrix.at<double>(1, 1), 0x1p-8),
                  .cx_px = coarse(matrix.at<double>(0, 2), 0x1p-8),
                  .cy_px = coarse(matrix.at<double>(1, 2), 0x1p-8),
                  .distortion = {coarse(distortion.at<double>(0), 0x1p-16), 0.0, 0.0, 0.0, 0.0}};
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    first.camera_from_board.push_back(transform_of(rotations[i], translations[i]));
  }
  return first;
}

}  // namespace tuina::calibration
