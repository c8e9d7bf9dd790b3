// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>

#include "tuina/scanner/line/clear_row.hpp"
#include "tuina/scanner/line/line_candidates.hpp"

namespace tuina::scanner {

// Compiler vectors, one lane per row of a group. A batch has several groups, whose steps are
// independent and overlap in the pipeline.
inline constexpr std::size_t group = 8;
inline constexpr std::size_t groups = rows_at_once / group;
static_assert(rows_at_once % group == 0);
using Floats [[gnu::vector_size(4 * group)]] = float;
using Wholes [[gnu::vector_size(4 * group)]] = std::int32_t;

/// Features around the brightest pixel of a row; `Number` is a float or a vector with one lane per
/// row.
template <typename Number>
struct RowFacts {
  Number most;        ///< brightest pixel
  Number neighbour;   ///< brighter of its neighbours
  Number beside_sum;  ///< sum of eight pixels `beside_px` away, on the brighter side
  Number rival;       ///< brightest pixel at least `beside_px` away
  Number spike;       ///< largest excess of a pixel in the kernel's window over both neighbours
};

/// Tests for one clear line: `clear` is then not zero.
template <typename Number, typename Answer>
[[gnu::always_inline]] inline void test_clear(const RowFacts<Number>& facts, const RowRule& rule,
                                              Answer& clear) {
  const Number beside = 0.125F * facts.beside_sum;
  const Number height = facts.most - beside;
  const Number rival = facts.rival - beside;
  clear = (facts.most < rule.saturated_dn) & (height >= rule.min_height_dn) &
          (facts.neighbour - beside >= 0.25F * height) &
          ((rival <= rival_share * height) | (rival <= rule.min_height_dn)) &
          (facts.spike <= rule.min_spike_dn + rule.spike_share * height);
}

/// Kernel steps in all rows of a batch. `weigh(rows, first, phase, kernel, offset, height)` returns
/// the two weighted sums over the windows beginning at these columns of a group. Each instruction
/// set inlines its own `weigh`.
template <typename Weigh>
[[gnu::always_inline]] inline void walk_with(Weigh weigh, const RowBatch& rows,
                                             const LineKernel& kernel, int steps, LineWalk& walk) {
  constexpr float phases = LineKernel::phases;
  Floats from[groups];
  std::memcpy(from, walk.column_px.data(), sizeof from);
  Floats column[groups];
  std::memcpy(column, from, sizeof from);
  Wholes height[groups] = {};
  for (int step = 0; step < steps; ++step) {
    for (std::size_t g = 0; g < groups; ++g) {
      // Columns are positive, so the conversion rounds down.
      const Wholes nearest = __builtin_convertvector(column[g] + 0.5F, Wholes);
      const Floats pixel = __builtin_convertvector(nearest, Floats) - 0.5F;
      const Wholes at = __builtin_convertvector((column[g] - pixel) * phases, Wholes);
      const Wholes phase = at < LineKernel::phases ? at : at - 1;
      Wholes offset;
      weigh(rows.data() + g * group, nearest - LineKernel::before, phase, kernel, offset,
            height[g]);
      const Wholes divisor = height[g] > 1 ? height[g] : height[g] * 0 + 1;
      const Floats move =
          __builtin_convertvector(offset, Floats) / __builtin_convertvector(divisor, Floats);
      const Floats to = pixel + (__builtin_convertvector(phase, Floats) + 0.5F) * (1.0F / phases) +
                        move * kernel.whole_offset;
      // A line so far away is none: the height becomes zero, and the next step starts again.
      const Wholes led =
          (height[g] > 0) & (to - from[g] <= max_walk_px) & (from[g] - to <= max_walk_px);
      column[g] = led ? to : from[g];
      height[g] &= led;
    }
  }
  Floats height_dn[groups];
  for (std::size_t g = 0; g < groups; ++g) {
    height_dn[g] = __builtin_convertvector(height[g], Floats) * kernel.whole_height;
  }
  std::memcpy(walk.column_px.data(), column, sizeof column);
  std::memcpy(walk.height_dn.data(), height_dn, sizeof height_dn);
}

}  // namespace tuina::scanner
