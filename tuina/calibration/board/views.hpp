// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/calibration/board/shots.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::calibration {

/// How far the paper reaches beyond the inner corners, at least.
inline constexpr double rim_squares = 0.8;

/// The board in one picture.
struct SeenBoard {
  std::vector<Vector2> corners_px;
  std::vector<int> which;  ///< of its inner corners, counted row by row; empty: all of them
  std::array<Vector2, 4> outline_px;  ///< of the paper, one corner after the other
};

/// What one look at a board gave: its inner corners, row by row, and the laser line in the picture
/// that was taken of the same pose with the laser on, if one was.
struct View {
  int frame = 0;  ///< of the picture of the bare board
  int pose = 0;
  double yaw_rad = 0.0;  ///< as the motor told it
  std::vector<Vector2> corners_px;
  std::vector<int> which = {};  ///< as in SeenBoard
  bool laser_on = false;
  std::vector<scanner::LinePoint> line;
  [[nodiscard]] int corner(std::size_t k) const {
    return which.empty() ? static_cast<int>(k) : which[k];
  }
};

/// Where an inner corner is in the frame of the board.
[[nodiscard]] inline Vector3 corner_on(const Board& board, int corner) {
  return board.square_m * Vector3(corner % board.columns, corner / board.columns, 0.0);
}

/// All that the fit needs to know of a set of pictures.
struct Views {
  Board board;
  int width_px = 0;
  int height_px = 0;
  int board_pictures = 0;  ///< taken; the board was found in `views.size()` of them
  std::vector<View> views;
};

/// Looks for the board and for the line in every picture, on `threads` threads. Fails when a
/// picture cannot be read, pictures differ in size, or most of them show no board.
[[nodiscard]] Result<Views> look_at(const Shots& shots, const Progress& progress = {},
                                    int threads = 2);

}  // namespace tuina::calibration
