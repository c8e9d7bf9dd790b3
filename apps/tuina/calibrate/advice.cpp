// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "apps/tuina/calibrate/report.hpp"

namespace tuina::app {
namespace {

using namespace calibration;

constexpr int good_poses = 30;
constexpr int coverage_columns = 3;
constexpr int coverage_rows = 4;
constexpr double odd_one_out = 2.5;  // times the median residual
constexpr double nearest_scan_m = 0.65;
constexpr double max_scan_m = 1.75;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Parts of the image in which no corner was ever seen.
std::string uncovered(const Views& views) {
  std::array<std::array<bool, coverage_columns>, coverage_rows> seen{};
  for (const View& view : views.views) {
    for (const Vector2& corner : view.corners_px) {
      const auto part = [](double at, int size, int parts) {
        return static_cast<std::size_t>(
            std::clamp(static_cast<int>(at * parts / size), 0, parts - 1));
      };
      seen[part(corner.y(), views.height_px, coverage_rows)]
          [part(corner.x(), views.width_px, coverage_columns)] = true;
    }
  }
  constexpr std::array<const char*, coverage_rows> heights = {"top", "upper middle", "lower middle",
                                                              "bottom"};
  constexpr std::array<const char*, coverage_columns> sides = {"left", "middle", "right"};
  std::string missing;
  for (std::size_t y = 0; y < seen.size(); ++y) {
    for (std::size_t x = 0; x < seen[y].size(); ++x) {
      if (seen[y][x]) continue;
      missing += fmt::format("{}{} {}", missing.empty() ? "" : ", ", heights[y], sides[x]);
    }
  }
  return missing;
}

}  // namespace

std::vector<std::string> advice(const Calibrated& result, const Views& views) {
  std::vector<std::string> sentences;
  std::vector<double> depths;
  std::vector<double> corners;
  std::vector<double> lines;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    corners.push_back(residual.reprojection_px);
    if (residual.line_points == 0) continue;
    lines.push_back(residual.line_share);
    depths.push_back(result.fit.geometry.camera_from_board[i].translation().z());
  }
  std::set<int> odd;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    if (residual.reprojection_px > odd_one_out * median(corners) ||
        residual.line_share > odd_one_out * median(lines)) {
      odd.insert(views.views[i].pose);
    }
  }
  if (!odd.empty()) {
    sentences.push_back(fmt::format(
        "{} with the rest less than it should: blurred, moved between its two "
        "pictures, or another lamp? Take it again.",
        odd.size() == 1 ? fmt::format("Pose {} agrees", *odd.begin())
                        : fmt::format("Each of the poses {} agrees", fmt::join(odd, ", "))));
  }
  if (result.poses < good_poses) {
    sentences.push_back(fmt::format(
        "{} poses with board and laser; the error shrinks with their number, 40 are good.",
        result.poses));
  }
  const auto [near, far] = std::minmax_element(depths.begin(), depths.end());
  if (*near > nearest_scan_m) {
    sentences.push_back(fmt::format("No board was nearer than {:.2f} m: hold some at {} m.", *near,
                                    nearest_scan_m));
  }
  if (*far < 0.9 * max_scan_m) {
    sentences.push_back(fmt::format(
        "No board was farther than {:.2f} m: beyond it the range is only a guess.", *far));
  }
  if (const std::string missing = uncovered(views); !missing.empty()) {
    sentences.push_back(
        fmt::format("No corner was ever seen in these parts of the image: {}.", missing));
  }
  const auto lost = static_cast<std::size_t>(views.board_pictures) - views.views.size();
  if (lost > 0) {
    sentences.push_back(fmt::format("The board was not found in {} of {} pictures of it.", lost,
                                    views.board_pictures));
  }
  sentences.insert(sentences.end(), result.remarks.begin(), result.remarks.end());
  sentences.push_back(fmt::format(
      "All lengths are those of squares of {:g} mm, and no picture shows whether that is right: "
      "scan a ball or a box of known size (tuina scan --check-sphere, --check-box).",
      to_mm(views.board.square_m)));
  return sentences;
}

}  // namespace tuina::app
