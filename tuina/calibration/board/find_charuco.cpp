// SPDX-License-Identifier: Apache-2.0
// Only this file and find_board.cpp use OpenCV.
#include "tuina/calibration/board/find_charuco.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <set>
#include <vector>

#include "tuina/calibration/board/refine_corner.hpp"
#include "tuina/core/grid.hpp"

namespace tuina::calibration {
namespace {

using Quad = std::array<cv::Point2f, 4>;  // clockwise

constexpr std::size_t min_outline_px = 28;
constexpr std::size_t fewest_markers = 2;
constexpr std::size_t fewest_corners = 8;
constexpr double window_per_square = 0.4;
constexpr int min_window_px = 3;
constexpr int max_window_px = 9;
constexpr int min_contrast_dn = 15;

// Dark quadrilaterals, candidates for a marker with its black frame. Light and marker size vary, so
// pixels are thresholded against surroundings of three sizes.
std::vector<Quad> dark_quads(const cv::Mat& grey) {
  std::vector<Quad> quads;
  for (const int surroundings_px : {11, 25, 61}) {
    cv::Mat dark;
    cv::adaptiveThreshold(grey, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV,
                          surroundings_px, 7);
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(dark, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    for (const auto& outline : outlines) {
      if (outline.size() < min_outline_px) continue;
      std::vector<cv::Point> corners;
      cv::approxPolyDP(outline, corners, 0.06 * static_cast<double>(outline.size()), true);
      if (corners.size() != 4 || !cv::isContourConvex(corners)) continue;
      if (cv::contourArea(corners, true) < 0.0) std::reverse(corners.begin(), corners.end());
      Quad quad;
      std::copy(corners.begin(), corners.end(), quad.begin());
      // The outline runs through the centres of the outermost dark pixels.
      const cv::Point2f middle = 0.25F * (quad[0] + quad[1] + quad[2] + quad[3]);
      for (cv::Point2f& corner : quad) {
        const cv::Point2f out = corner - middle;
        corner += out * (0.7F / static_cast<float>(std::max(1.0, cv::norm(out))));
      }
      quads.push_back(quad);
    }
  }
  return quads;
}

cv::Point2d through(const cv::Matx33d& homography, const cv::Point2d& at) {
  const cv::Vec3d to = homography * cv::Vec3d(at.x, at.y, 1.0);
  return {to[0] / to[2], to[1] / to[2]};
}

// Cells of a marker; nothing without a black frame.
std::optional<std::vector<bool>> read_cells(const cv::Mat& grey, const Quad& quad, int inside) {
  const int all = inside + 2;
  const auto side = static_cast<float>(all);
  const Quad square = {cv::Point2f(0, 0), {side, 0}, {side, side}, {0, side}};
  const cv::Matx33d image_from_cells = cv::getPerspectiveTransform(square.data(), quad.data());
  std::vector<double> cells;
  for (int y = 0; y < all; ++y) {
    for (int x = 0; x < all; ++x) {
      double sum = 0.0;
      for (const double dy : {0.3, 0.5, 0.7}) {
        for (const double dx : {0.3, 0.5, 0.7}) {
          const cv::Point2d at = through(image_from_cells, {x + dx, y + dy});
          const auto column = static_cast<int>(std::lround(at.x));
          const auto row = static_cast<int>(std::lround(at.y));
          if (column < 0 || row < 0 || column >= grey.cols || row >= grey.rows) {
            return std::nullopt;
          }
          sum += grey.at<std::uint8_t>(row, column);
        }
      }
      cells.push_back(sum / 9.0);
    }
  }
  const auto [darkest, brightest] = std::minmax_element(cells.begin(), cells.end());
  if (*brightest - *darkest < min_contrast_dn) return std::nullopt;
  const double between = 0.5 * (*brightest + *darkest);
  std::vector<bool> white;
  int bright_frame = 0;
  for (int y = 0; y < all; ++y) {
    for (int x = 0; x < all; ++x) {
      const bool bright = cells[grid_index(y, all, x)] > between;
      const bool frame = x == 0 || y == 0 || x == all - 1 || y == all - 1;
      if (!frame) white.push_back(bright);
      if (frame && bright) ++bright_frame;
    }
  }
  if (bright_frame > 1) return std::nullopt;
  return white;
}

struct SeenMarker {
  std::size_t which = 0;  ///< index in the board's markers
  Quad corners;           ///< in the image, beginning with the marker's first corner
};

// Identifies marker and rotation from the cells.
std::optional<SeenMarker> recognise(const std::vector<bool>& white, const Quad& quad, int inside,
                                    const std::vector<scanner::Marker>& markers) {
  // The smallest dictionaries differ by at least four cells, so one error is correctable.
  constexpr int misread = 1;
  for (int turn = 0; turn < 4; ++turn) {
    std::uint64_t cells = 0;
    for (int y = 0; y < inside; ++y) {
      for (int x = 0; x < inside; ++x) {
        // Cell (x, y) of a marker whose first corner is the quad's corner `turn`.
        int from_x = x;
        int from_y = y;
        for (int i = 0; i < turn; ++i) {
          const int old_x = from_x;
          from_x = inside - 1 - from_y;
          from_y = old_x;
        }
        cells = 2 * cells + (white[grid_index(from_y, inside, from_x)] ? 1 : 0);
      }
    }
    for (std::size_t i = 0; i < markers.size(); ++i) {
      if (std::popcount(cells ^ markers[i].cells) > misread) continue;
      SeenMarker seen{.which = i, .corners = quad};
      std::rotate(seen.corners.begin(), seen.corners.begin() + turn, seen.corners.end());
      return seen;
    }
  }
  return std::nullopt;
}

// Corners of a marker on the board, in squares from the first inner corner.
Quad place_of(const scanner::Marker& marker, const Board& board) {
  const auto half = static_cast<float>(0.5 * board.marker_m / board.square_m);
  const cv::Point2f middle(static_cast<float>(marker.column) - 0.5F,
                           static_cast<float>(marker.row) - 0.5F);
  return {middle + cv::Point2f(-half, -half), middle + cv::Point2f(half, -half),
          middle + cv::Point2f(half, half), middle + cv::Point2f(-half, half)};
}

// Markers consistent with one board pose.
struct Agreed {
  std::vector<cv::Point2f> on_board;  ///< in squares
  std::vector<cv::Point2f> in_image;
  cv::Matx33d image_from_board;
  bool first_is_black = true;  ///< colour of the board's first square
};

std::optional<Agreed> agree(const std::vector<SeenMarker>& seen,
                            const std::vector<scanner::Marker>& markers, const Board& board) {
  std::vector<cv::Point2f> on_board;
  std::vector<cv::Point2f> in_image;
  for (const SeenMarker& marker : seen) {
    const Quad place = place_of(markers[marker.which], board);
    on_board.insert(on_board.end(), place.begin(), place.end());
    in_image.insert(in_image.end(), marker.corners.begin(), marker.corners.end());
  }
  if (on_board.size() < 4 * fewest_markers) return std::nullopt;
  constexpr double tolerated_px = 4.0;  // lens distortion and outline errors
  std::vector<std::uint8_t> fits;
  const cv::Mat found = cv::findHomography(on_board, in_image, cv::RANSAC, tolerated_px, fits);
  if (found.empty()) return std::nullopt;
  Agreed agreed{.on_board = {}, .in_image = {}, .image_from_board = found};
  std::set<std::size_t> markers_in;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i] == 0) continue;
    agreed.on_board.push_back(on_board[i]);
    agreed.in_image.push_back(in_image[i]);
    markers_in.insert(seen[i / 4].which);
  }
  if (markers_in.size() < fewest_markers) return std::nullopt;
  return agreed;
}

// Local homography near a corner, from the detections beside it, since the lens bends the board.
cv::Matx33d around(const Agreed& agreed, const cv::Point2f& corner, std::size_t points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < agreed.on_board.size(); ++i) {
    if (cv::norm(agreed.on_board[i] - corner) > 1e-3) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cv::norm(agreed.on_board[a] - corner) < cv::norm(agreed.on_board[b] - corner);
  });
  std::vector<cv::Point2f> on_board;
  std::vector<cv::Point2f> in_image;
  for (std::size_t i = 0; i < std::min(points, order.size()); ++i) {
    on_board.push_back(agreed.on_board[order[i]]);
    in_image.push_back(agreed.in_image[order[i]]);
  }
  const cv::Mat found = cv::findHomography(on_board, in_image, 0);
  return found.empty() ? agreed.image_from_board : cv::Matx33d(found);
}

// Refines one inner corner from the edges of its squares, without markers.
std::optional<Vector2> find_corner(ImageView image, const cv::Matx33d& image_from_board,
                                   const cv::Point2d& corner, const Board& board, int first_black) {
  const cv::Point2d start = through(image_from_board, corner);
  const double side_px =
      std::min(cv::norm(through(image_from_board, corner + cv::Point2d(0.5, 0.0)) -
                        through(image_from_board, corner - cv::Point2d(0.5, 0.0))),
               cv::norm(through(image_from_board, corner + cv::Point2d(0.0, 0.5)) -
                        through(image_from_board, corner - cv::Point2d(0.0, 0.5))));
  const int window =
      std::clamp(static_cast<int>(window_per_square * side_px), min_window_px, max_window_px);
  const auto in_image = [&](const cv::Point2d& at) {
    return at.x > window + 2 && at.y > window + 2 && at.x < image.width - window - 3 &&
           at.y < image.height - window - 3;
  };
  if (!in_image(start)) return std::nullopt;
  const cv::Matx33d board_from_image = image_from_board.inv();
  // Half way between the border of a square and its marker.
  const double marker_from = 0.25 * (1.0 - board.marker_m / board.square_m);
  const auto counts = [&](int x, int y) {
    const cv::Point2d at = through(board_from_image, cv::Point2d(x, y));
    const cv::Point2d square(std::floor(at.x), std::floor(at.y));
    if (std::lround(square.x + square.y + first_black) % 2 == 0) return true;  // black
    const double to_border = std::min(std::min(at.x - square.x, square.x + 1.0 - at.x),
                                      std::min(at.y - square.y, square.y + 1.0 - at.y));
    return to_border < marker_from;
  };
  auto found = refine_corner(image, {start.x, start.y}, window, counts);
  if (!found || (*found - Vector2(start.x, start.y)).norm() > std::max(3.0, 0.15 * side_px)) {
    return std::nullopt;
  }
  // Two of the four squares are black, the others white beside their markers.
  double contrast = 0.0;
  for (const auto& [dx, dy] : {std::pair{-1, -1}, {1, 1}, {1, -1}, {-1, 1}}) {
    const cv::Point2d shift = through(image_from_board, corner + cv::Point2d(0.1 * dx, 0.1 * dy)) -
                              start + cv::Point2d(found->x(), found->y());
    const int seen =
        image.row(static_cast<int>(std::lround(shift.y)))[static_cast<int>(std::lround(shift.x))];
    const auto square = std::lround(corner.x + corner.y) + first_black + (dx == dy ? 0 : 1);
    contrast += 0.5 * (square % 2 == 0 ? -seen : seen);
  }
  if (contrast < min_contrast_dn) return std::nullopt;
  return found;
}

// Removes corners that disagree with their neighbours (a finger, a reflection), worst first.
void leave_out_odd_ones(Agreed& corners) {
  constexpr double min_tolerated_px = 0.4;
  constexpr double tolerated_squares = 0.015;  // rounding of printers and drawings
  const auto tolerated_px = [&](const cv::Point2d& at) {
    const double side_px = cv::norm(through(corners.image_from_board, at + cv::Point2d(1.0, 0.0)) -
                                    through(corners.image_from_board, at));
    return std::max(min_tolerated_px, tolerated_squares * side_px);
  };
  while (corners.on_board.size() > fewest_corners) {
    std::size_t worst = 0;
    double most = 0.0;
    for (std::size_t i = 0; i < corners.on_board.size(); ++i) {
      const cv::Point2d expected =
          through(around(corners, corners.on_board[i], 10), corners.on_board[i]);
      const double off =
          cv::norm(expected - cv::Point2d(corners.in_image[i])) / tolerated_px(corners.on_board[i]);
      if (off > most) {
        most = off;
        worst = i;
      }
    }
    if (most < 1.0) return;
    corners.on_board.erase(corners.on_board.begin() + static_cast<std::ptrdiff_t>(worst));
    corners.in_image.erase(corners.in_image.begin() + static_cast<std::ptrdiff_t>(worst));
  }
}

SeenBoard corners_of(ImageView image, const Agreed& agreed, const Board& board) {
  Agreed corners{.on_board = {}, .in_image = {}, .image_from_board = agreed.image_from_board};
  std::vector<Vector2> all(static_cast<std::size_t>(board.corners()));
  for (int i = 0; i < board.corners(); ++i) {
    const int column = i % board.columns, row = i / board.columns;
    const cv::Point2f corner(static_cast<float>(column), static_cast<float>(row));
    const auto found = find_corner(image, around(agreed, corner, 24), corner, board,
                                   agreed.first_is_black ? 0 : 1);
    if (!found) continue;
    all[static_cast<std::size_t>(i)] = *found;
    corners.on_board.push_back(corner);
    corners.in_image.emplace_back(static_cast<float>(found->x()), static_cast<float>(found->y()));
  }
  leave_out_odd_ones(corners);
  SeenBoard seen;
  for (const cv::Point2f& corner : corners.on_board) {
    const int i = static_cast<int>(corner.y) * board.columns + static_cast<int>(corner.x);
    seen.corners_px.push_back(all[static_cast<std::size_t>(i)]);
    seen.which.push_back(i);
  }
  const double right = board.columns - 1 + rim_squares;
  const double below = board.rows - 1 + rim_squares;
  const std::array<cv::Point2d, 4> paper = {cv::Point2d(-rim_squares, -rim_squares),
                                            {right, -rim_squares},
                                            {right, below},
                                            {-rim_squares, below}};
  for (std::size_t i = 0; i < paper.size(); ++i) {
    const cv::Point2d at = through(agreed.image_from_board, paper[i]);
    seen.outline_px[i] = {at.x, at.y};
  }
  return seen;
}

}  // namespace

std::optional<SeenBoard> find_charuco(ImageView image, const Board& board) {
  const cv::Mat grey(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  try {
    std::optional<Agreed> best;
    const auto quads = dark_quads(grey);
    // OpenCV before 4.6 began boards with an even number of rows with a white square.
    for (const bool first_is_black : {true, false}) {
      if (!first_is_black && board.rows % 2 == 0) continue;
      const auto markers = scanner::markers_of(board, first_is_black);
      std::vector<SeenMarker> seen;
      for (const Quad& quad : quads) {
        const auto white = read_cells(grey, quad, board.marker_cells);
        if (!white) continue;
        const auto marker = recognise(*white, quad, board.marker_cells, markers);
        if (marker) seen.push_back(*marker);
      }
      auto agreed = agree(seen, markers, board);
      if (agreed) agreed->first_is_black = first_is_black;
      if (agreed && (!best || agreed->on_board.size() > best->on_board.size())) {
        best = std::move(agreed);
      }
    }
    if (!best) return std::nullopt;
    SeenBoard seen = corners_of(image, *best, board);
    if (seen.which.size() < fewest_corners) return std::nullopt;
    return seen;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

}  // namespace tuina::calibration
