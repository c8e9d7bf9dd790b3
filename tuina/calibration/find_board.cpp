// SPDX-License-Identifier: Apache-2.0
// The only file that knows OpenCV.
#include "tuina/calibration/find_board.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tuina::calibration {
namespace {

// The window in which a corner is refined must not reach its neighbours.
constexpr double window_per_square = 0.4;
constexpr int smallest_window_px = 2;
constexpr int largest_window_px = 9;

double shortest_side_px(const std::vector<cv::Point2f>& corners, const Board& board) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int y = 0; y < board.rows; ++y) {
    for (int x = 0; x < board.columns; ++x) {
      const auto i = static_cast<std::size_t>(y * board.columns + x);
      if (x > 0) shortest = std::min(shortest, cv::norm(corners[i] - corners[i - 1]));
      if (y > 0) {
        const auto above = i - static_cast<std::size_t>(board.columns);
        shortest = std::min(shortest, cv::norm(corners[i] - corners[above]));
      }
    }
  }
  return shortest;
}

// cornerSubPix reads gradients between pixels and is off by 0.02 px for it, a different way at each
// fraction of a pixel. At whole pixels the same condition - every gradient is upright to the way to
// the corner - is solved without that error.
Vector2 refined(ImageView image, Vector2 corner, int window) {
  const double reach = 0.6 * window;
  for (int step = 0; step < 20; ++step) {
    const auto x0 = static_cast<int>(std::lround(corner.x()));
    const auto y0 = static_cast<int>(std::lround(corner.y()));
    if (x0 - window < 1 || y0 - window < 1 || x0 + window > image.width - 2 ||
        y0 + window > image.height - 2) {
      break;
    }
    Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();
    Vector2 moments = Vector2::Zero();
    for (int y = y0 - window; y <= y0 + window; ++y) {
      const std::uint8_t* row = image.row(y);
      for (int x = x0 - window; x <= x0 + window; ++x) {
        const Vector2 slope(row[x + 1] - row[x - 1], image.row(y + 1)[x] - image.row(y - 1)[x]);
        const Vector2 at(x, y);
        const double weight = std::exp(-0.5 * (at - corner).squaredNorm() / (reach * reach));
        sums += weight * slope * slope.transpose();
        moments += weight * slope * slope.dot(at);
      }
    }
    const Vector2 next = sums.ldlt().solve(moments);
    // A corner that runs away was none that this can refine.
    if (!((next - corner).norm() < 1.0)) break;
    const bool settled = (next - corner).norm() < 1e-5;
    corner = next;
    if (settled) break;
  }
  return corner;
}

std::vector<cv::Point3f> corners_on(const Board& board) {
  std::vector<cv::Point3f> points;
  for (int y = 0; y < board.rows; ++y) {
    for (int x = 0; x < board.columns; ++x) {
      points.emplace_back(static_cast<float>(x * board.square_m),
                          static_cast<float>(y * board.square_m), 0.0F);
    }
  }
  return points;
}

Transform transform_of(const cv::Mat& rotation, const cv::Mat& translation) {
  const Vector3 turn(rotation.at<double>(0), rotation.at<double>(1), rotation.at<double>(2));
  Transform transform = Transform::Identity();
  if (const double angle = turn.norm(); angle > 0.0) {
    transform.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  transform.translation() =
      Vector3(translation.at<double>(0), translation.at<double>(1), translation.at<double>(2));
  return transform;
}

}  // namespace

std::optional<std::vector<Vector2>> find_corners(ImageView image, const Board& board) {
  const cv::Mat grey(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  const cv::Size pattern(board.columns, board.rows);
  std::vector<cv::Point2f> corners;
  int window = 0;
  try {
    constexpr int quick = cv::CALIB_CB_NORMALIZE_IMAGE;
    constexpr int thorough = quick | cv::CALIB_CB_EXHAUSTIVE;
    if (!cv::findChessboardCornersSB(grey, pattern, corners, quick) &&
        !cv::findChessboardCornersSB(grey, pattern, corners, thorough)) {
      return std::nullopt;
    }
    // The corners of findChessboardCornersSB (OpenCV 4.6) are off by 0.01 to 0.03 px even in clean
    // pictures, which costs pixels of focal length; the gradients around each corner know better.
    window = std::clamp(static_cast<int>(window_per_square * shortest_side_px(corners, board)),
                        smallest_window_px, largest_window_px);
    cv::cornerSubPix(grey, corners, {window, window}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4});
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  std::vector<Vector2> found;
  found.reserve(corners.size());
  for (const cv::Point2f& corner : corners) {
    found.push_back(refined(image, {corner.x, corner.y}, window));
  }
  return found;
}

Result<FirstCamera> calibrate_camera(const Views& views) {
  const std::vector<std::vector<cv::Point3f>> boards(views.views.size(), corners_on(views.board));
  std::vector<std::vector<cv::Point2f>> pictures;
  for (const View& view : views.views) {
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
    // Without distortion first: it is the joint fit that knows how much of it there can be.
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
                  .fx_px = matrix.at<double>(0, 0),
                  .fy_px = matrix.at<double>(1, 1),
                  .cx_px = matrix.at<double>(0, 2),
                  .cy_px = matrix.at<double>(1, 2),
                  .distortion = {distortion.at<double>(0), 0.0, 0.0, 0.0, 0.0}};
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    first.camera_from_board.push_back(transform_of(rotations[i], translations[i]));
  }
  return first;
}

}  // namespace tuina::calibration
