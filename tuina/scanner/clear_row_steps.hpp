// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>

#include "tuina/scanner/clear_row.hpp"

namespace tuina::scanner {

/// The two weighted sums of a kernel over the pixels of its window.
struct LineSums {
  std::int32_t offset = 0;
  std::int32_t height = 0;
};

/// Steps of the kernel in all rows of a batch; `weigh(pixels, weights)` gives the sums. Each set of
/// instructions inlines it with a `weigh` of its own, and the loops over the batch become vectors.
template <typename Weigh>
[[gnu::always_inline]] inline void walk_with(Weigh weigh, const RowBatch& rows,
                                             const LineKernel& kernel, int steps, LineWalk& walk) {
  // Vectors of the compiler, as wide as the batch: it makes of them what the instructions allow.
  using Floats [[gnu::vector_size(4 * rows_at_once)]] = float;
  using Wholes [[gnu::vector_size(4 * rows_at_once)]] = std::int32_t;
  static_assert(sizeof(Floats) == sizeof(walk.column_px));
  constexpr float phases = LineKernel::phases;
  Floats from;
  std::memcpy(&from, walk.column_px.data(), sizeof from);
  Floats column = from;
  Wholes height = {};
  for (int step = 0; step < steps; ++step) {
    // Columns are positive, so the conversion rounds down.
    const Wholes nearest = __builtin_convertvector(column + 0.5F, Wholes);
    const Floats pixel = __builtin_convertvector(nearest, Floats) - 0.5F;
    const Wholes at = __builtin_convertvector((column - pixel) * phases, Wholes);
    const Wholes phase = at < LineKernel::phases ? at : at - 1;
    Wholes offset = {};
    for (std::size_t i = 0; i < rows_at_once; ++i) {
      const LineSums sums = weigh(rows[i] + nearest[i] - LineKernel::before,
                                  kernel.whole_of_phase[static_cast<std::size_t>(phase[i])]);
      offset[i] = sums.offset;
      height[i] = sums.height;
    }
    const Floats move = __builtin_convertvector(offset, Floats) /
                        __builtin_convertvector(height > 1 ? height : height * 0 + 1, Floats);
    const Floats to = pixel + (__builtin_convertvector(phase, Floats) + 0.5F) * (1.0F / phases) +
                      move * kernel.whole_offset;
    // No line leads so far; the height says so, and the walk goes on from where it began.
    const Wholes led =
        (height > 0) & (to - from <= farthest_walk_px) & (from - to <= farthest_walk_px);
    column = led ? to : from;
    height &= led;
  }
  const Floats height_dn = __builtin_convertvector(height, Floats) * kernel.whole_height;
  std::memcpy(walk.column_px.data(), &column, sizeof column);
  std::memcpy(walk.height_dn.data(), &height_dn, sizeof height_dn);
}

}  // namespace tuina::scanner
