// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace tuina::scanner {

/// A printed chessboard or ChArUco board, described by its inner corners. Board frame: x along the
/// columns, y along the rows, z into the board away from the camera, origin at the first inner
/// corner. The markers of a ChArUco board, one per white square, identify a part of it.
struct Board {
  int columns = 7;
  int rows = 10;
  double square_m = 0.025;
  double marker_m = 0.0;  ///< side of a marker with its black frame; 0: a plain chessboard
  int marker_cells = 4;   ///< cells along a side without the frame: 4, 5 or 6
  [[nodiscard]] int corners() const { return columns * rows; }  ///< inner corners of the pattern
  /// Whether its squares carry markers.
  [[nodiscard]] bool has_markers() const { return marker_m > 0.0; }
};

/// A marker of a ChArUco board: its square, counted from the first one, and its cells row by row,
/// the first in the highest bit; 1 is white.
struct Marker {
  int column = 0;
  int row = 0;
  std::uint64_t cells = 0;
};

/// Size of OpenCV's smallest dictionaries; the larger ones begin with the same markers.
inline constexpr int max_markers = 50;
/// Number of markers of a ChArUco board of this size: half of its squares.
[[nodiscard]] int marker_count(const Board& board);

/// Markers of a board with at most `max_markers`, in OpenCV's layout: by rows, the first square
/// black. Before version 4.6, boards with an even number of rows of squares began with a white one.
[[nodiscard]] std::vector<Marker> markers_of(const Board& board, bool first_is_black = true);

}  // namespace tuina::scanner
