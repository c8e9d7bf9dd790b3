// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>

#include "tuina/scanner/line/clear_row.hpp"
#include "tuina/scanner/line/line_candidates.hpp"

namespace tuina::scanner {

// Vectors of the compiler, a number for each row of a group: it makes of them what the instructions
// allow. A batch is several groups, because a step of one waits for the step before while the steps
// of another can be done.
inline constexpr std::size_t group = 8;
inline constexpr std::size_t groups = rows_at_once / group;
static_assert(rows_at_once % group == 0);
using Floats [[gnu::vector_size(4 * group)]] = float;
using Wholes [[gnu::vector_size(4 * group)]] = std::int32_t;

/// What the pixels around the brightest one of a row tell; `Number` is a float, or as many of them
/// as a group has rows.
template <typename Number>
struct RowFacts {
  Number most;        ///< the brightest pixel
  Number neighbour;   ///< the brighter pixel next to it
  Number beside_sum;  ///< eight pixels `beside_px` away from it, on the brighter side
  Number rival;       ///< the brightest pixel at least `beside_px` away
  Number spike;       ///< by how much a pixel of the kernel's window outshines both its neighbours
};

/// Whether that is one clear line: `clear` is not zero.
template <typename Number, typename Answer>
[[gnu::always_inline]] inline void judge(const RowFacts<Number>& facts, const RowRule& rule,
                                         Answer& clear) {
  const Number beside = 0.125F * facts.beside_sum;
  const Number height = facts.most - beside;
  const Number rival = facts.rival - beside;
  clear = (facts.most < rule.saturated_dn) & (height >= rule.min_height_dn) &
          (facts.neighbour - beside >= 0.25F * height) &
          ((rival <= rival_share * height) | (rival <= rule.min_height_dn)) &
          (facts.spike <= rule.min_spike_dn + rule.spike_share * height);
}

/// Steps of the kernel in all rows of a batch; `weigh(rows, first, phase, kernel, offset, height)`
/// gives the two weighted sums over the windows that begin at these columns of the rows of a group.
/// Each set of instructions inlines it with a `weigh` of its own.
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
      // No line leads so far; the height says so, and the walk goes on from where it began.
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
