// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tuina/scanner/line/line_kernel.hpp"

namespace tuina::scanner {

/// A walk that leads farther from the brightest pixel was not led by a line.
inline constexpr float max_walk_px = 4.0F;

/// When a row of 8-bit pixels shows one clear line and nothing else.
struct RowRule {
  int first = 0;  ///< of the columns that are looked at
  int last = 0;
  int beside_px = 9;            ///< from here on a pixel beside the line shows background
  int min_dn = 0;               ///< of the brightest pixel of a row with a line
  float min_height_dn = 0.0F;   ///< of a line, or of a rival, above what is beside it
  float saturated_dn = 255.0F;  ///< pixels at or above it are clipped
  float min_spike_dn = 0.0F;    ///< a hot pixel outshines its neighbours by so much,
  float spike_share = 0.0F;     ///< and this share of the line's height
  /// The brightest pixel must lie so far from either end for the pixels beside it to exist, and for
  /// a kernel to walk from it.
  [[nodiscard]] int margin_px() const {
    const int window_px = LineKernel::taps / 2 + static_cast<int>(max_walk_px) + 1;
    return beside_px + 8 > window_px ? beside_px + 8 : window_px;
  }
  [[nodiscard]] bool has_margin(int column) const {
    return column - first >= margin_px() && last - column >= margin_px();
  }
};

/// Rows are handled so many at once: one row alone is a chain of steps that wait for each other.
inline constexpr std::size_t rows_at_once = 16;
using RowBatch = std::array<const std::uint8_t*, rows_at_once>;

/// What a row shows: nothing as bright as a line, one clear line, or something else.
enum class RowView : std::uint8_t { dark, one_line, in_doubt };

/// What each row of a batch shows, and the first of its brightest columns; that of a dark row means
/// nothing.
struct BatchView {
  std::array<RowView, rows_at_once> view;
  std::array<int, rows_at_once> brightest;
};

/// Lines on their way to where they are, one of each row of a batch.
struct LineWalk {
  alignas(64) std::array<float, rows_at_once> column_px;  ///< from where, and where to
  alignas(64) std::array<float, rows_at_once> height_dn;  ///< not positive where no line led
};

/// The two functions that touch every pixel, in the version for this processor. The sums are of
/// whole numbers, so the versions agree but for the last digits of a division. Rows of a batch that
/// are not needed repeat another.
struct RowReader {
  /// `hint` is a column near which the lines may be; it only saves time.
  void (*look)(const RowBatch& rows, const RowRule& rule, int hint, BatchView& seen) noexcept;
  void (*walk)(const RowBatch& rows, const LineKernel& kernel, int steps, LineWalk& walk) noexcept;
};

[[nodiscard]] const RowReader& plain_row_reader() noexcept;
/// With AVX2 where the processor has it.
[[nodiscard]] const RowReader& row_reader() noexcept;

}  // namespace tuina::scanner
