// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tuina/scanner/line_kernel.hpp"

namespace tuina::scanner {

/// What one pass over a row of 8-bit pixels tells of its brightest place. Of a row that is nowhere
/// as bright as a line only `most` is told; where too little of the row is left beside that place
/// (RowSpan::has_margin), only `most` and `at`.
struct RowFacts {
  int most = 0;       ///< of the brightest pixel
  int at = 0;         ///< column of the first pixel as bright
  int left_sum = 0;   ///< of the eight pixels that end `beside_px` to the left of it
  int right_sum = 0;  ///< of the eight that begin as far to the right
  int rival = 0;      ///< of the brightest pixel at least `beside_px` away
  int neighbour = 0;  ///< of the brighter pixel next to it
  int spike = 0;      ///< by how much a pixel of the kernel's window outshines both its neighbours
};

/// A walk that leads farther from the brightest pixel was not led by a line.
inline constexpr float farthest_walk_px = 4.0F;

/// The columns that are looked at, from where on a pixel beside the line shows background, and how
/// bright a line is at least.
struct RowSpan {
  int first = 0;
  int last = 0;
  int beside_px = 9;
  int least_dn = 0;
  /// The brightest pixel must lie so far from either end for the facts beside it to exist, and for
  /// a kernel to walk from it.
  [[nodiscard]] int margin_px() const {
    const int window_px = LineKernel::taps / 2 + static_cast<int>(farthest_walk_px) + 1;
    return beside_px + 8 > window_px ? beside_px + 8 : window_px;
  }
  [[nodiscard]] bool has_margin(int column) const {
    return column - first >= margin_px() && last - column >= margin_px();
  }
};

/// Rows are handled so many at once: one row alone is a chain of steps that wait for each other.
inline constexpr std::size_t rows_at_once = 8;
using RowBatch = std::array<const std::uint8_t*, rows_at_once>;

/// Lines on their way to where they are, one of each row of a batch.
struct LineWalk {
  alignas(32) std::array<float, rows_at_once> column_px;  ///< from where, and where to
  alignas(32) std::array<float, rows_at_once> height_dn;  ///< not positive where no line led
};

/// The two functions that touch every pixel, in the version for this processor. The sums are of
/// whole numbers, so the versions agree but for the last digits of a division. Rows of a batch that
/// are not needed repeat another.
struct RowReader {
  /// `hint` is a column near which the lines may be; it only saves time.
  void (*read)(const RowBatch& rows, const RowSpan& span, int hint,
               std::array<RowFacts, rows_at_once>& facts) noexcept;
  void (*walk)(const RowBatch& rows, const LineKernel& kernel, int steps, LineWalk& walk) noexcept;
};

[[nodiscard]] const RowReader& plain_row_reader() noexcept;
/// With AVX2 where the processor has it.
[[nodiscard]] const RowReader& row_reader() noexcept;

}  // namespace tuina::scanner
