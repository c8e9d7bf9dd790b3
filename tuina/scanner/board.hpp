// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace tuina::scanner {

/// A flat printed board of black and white squares, by its inner corners. Board frame: x along the
/// columns, y along the rows, z into the board as the camera sees it, the origin at the first inner
/// corner. A ChArUco board has a marker in each white square, so a part of it is enough to know
/// which part that is.
struct Board {
  int columns = 7;
  int rows = 10;
  double square_m = 0.025;
  double marker_m = 0.0;  ///< side of a marker with its black frame; 0: a plain chessboard
  int marker_cells = 4;   ///< along a side, without the frame: 4, 5 or 6
  [[nodiscard]] int corners() const { return columns * rows; }
  [[nodiscard]] bool has_markers() const { return marker_m > 0.0; }
};

/// A marker of a ChArUco board: the square that it lies in, counted from the first one, and its
/// cells row by row, the first in the highest bit; 1 is white.
struct Marker {
  int column = 0;
  int row = 0;
  std::uint64_t cells = 0;
};

/// The size of the smallest of OpenCV's dictionaries; the first markers of the others are the same.
inline constexpr int max_markers = 50;
[[nodiscard]] int marker_count(const Board& board);

/// The markers of a board with `marker_count` of at most `max_markers`, as OpenCV lays them out:
/// by rows, the first square being black. Before version 4.6 a board with an even number of rows of
/// squares began with a white one.
[[nodiscard]] std::vector<Marker> markers_of(const Board& board, bool first_is_black = true);

}  // namespace tuina::scanner
