// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tuina/scanner/line/line_kernel.hpp"

namespace tuina::scanner {

/// Maximum distance of a line from the brightest pixel of its row.
inline constexpr float max_walk_px = 4.0F;

/// Criteria for a row of 8-bit pixels with one clear line and nothing else.
struct RowRule {
  int first = 0;  ///< first column searched
  int last = 0;
  int beside_px = 9;            ///< distance at which a pixel beside the line shows background
  int min_dn = 0;               ///< minimum brightness of the brightest pixel of a line
  float min_height_dn = 0.0F;   ///< minimum height of a line, or of a rival, above its background
  float saturated_dn = 255.0F;  ///< pixels at or above it are clipped
  float min_spike_dn = 0.0F;    ///< a hot pixel outshines its neighbours by this,
  float spike_share = 0.0F;     ///< plus this share of the line's height
  /// Minimum distance of the brightest pixel from either end, for background pixels and kernel
  /// window.
  [[nodiscard]] int margin_px() const {
    const int window_px = LineKernel::taps / 2 + static_cast<int>(max_walk_px) + 1;
    return beside_px + 8 > window_px ? beside_px + 8 : window_px;
  }
  /// Whether a line at this column has room for its window on both sides.
  [[nodiscard]] bool has_margin(int column) const {
    return column - first >= margin_px() && last - column >= margin_px();
  }
};

/// Rows are processed in batches: one row alone is a chain of dependent instructions.
inline constexpr std::size_t rows_at_once = 16;
using RowBatch = std::array<const std::uint8_t*, rows_at_once>;

/// Content of a row: nothing as bright as a line, one clear line, or something else.
enum class RowView : std::uint8_t { dark, one_line, in_doubt };

/// Content of each row of a batch, and the first of its brightest columns (undefined for dark
/// rows).
struct BatchView {
  std::array<RowView, rows_at_once> view;
  std::array<int, rows_at_once> brightest;
};

/// Line positions under refinement, one per row of a batch.
struct LineWalk {
  alignas(64) std::array<float, rows_at_once> column_px;  ///< start column, then line position
  alignas(64) std::array<float, rows_at_once> height_dn;  ///< not positive if there is no line
};

/// The two functions that touch every pixel, compiled for this processor. Sums are of integers, so
/// that all versions agree up to the last digits of a division. Pad a short batch by repeating any
/// row.
struct RowReader {
  /// `hint`: a column near the lines, for speed only.
  void (*classify)(const RowBatch& rows, const RowRule& rule, int hint, BatchView& seen) noexcept;
  void (*walk)(const RowBatch& rows, const LineKernel& kernel, int steps, LineWalk& walk) noexcept;
};

[[nodiscard]] const RowReader& plain_row_reader() noexcept;
/// AVX2 if the processor has it.
[[nodiscard]] const RowReader& row_reader() noexcept;

}  // namespace tuina::scanner
