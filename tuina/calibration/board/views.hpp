// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/calibration/board/shots.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::calibration {

/// Minimum width of the paper's rim beyond the inner corners.
inline constexpr double rim_squares = 0.8;

/// Detection of the board in one picture.
struct SeenBoard {
  std::vector<Vector2> corners_px;
  std::vector<int> which;  ///< indices of the inner corners, counted row by row; empty: all
  std::array<Vector2, 4> outline_px;  ///< corners of the paper, in order
};

/// Two readings of the motor that differ by less, a little more than one count, are of one yaw.
inline constexpr double same_yaw_rad = from_deg(0.35);

/// Measurements of one board pose: inner corners, row by row, and the laser line of the picture of
/// the same pose with the laser on, if there is one.
struct View {
  int frame = 0;  ///< number of the picture without laser
  int pose = 0;
  double yaw_rad = 0.0;  ///< motor reading
  std::vector<Vector2> corners_px;
  std::vector<int> which = {};  ///< indices of the corners, as in SeenBoard
  bool laser_on = false;
  std::vector<scanner::LinePoint> line;
  /// Index on the board of the k-th corner.
  [[nodiscard]] int corner(std::size_t k) const {
    return which.empty() ? static_cast<int>(k) : which[k];
  }
};

/// An inner corner in the board frame.
[[nodiscard]] inline Vector3 corner_on(const Board& board, int corner) {
  const int column = corner % board.columns, row = corner / board.columns;
  return board.square_m * Vector3(column, row, 0.0);
}

/// All measurements of a set of pictures.
struct Views {
  Board board;
  int width_px = 0;
  int height_px = 0;
  /// Pictures without laser; the board was found in `views.size()` of them.
  int board_pictures = 0;
  std::vector<View> views;
};

/// Detects board and line in every picture, on `threads` threads. Fails when a picture cannot be
/// read, sizes differ, or most pictures show no board.
[[nodiscard]] Result<Views> measure_views(const Shots& shots, const Progress& progress = {},
                                          int threads = 2);

}  // namespace tuina::calibration
