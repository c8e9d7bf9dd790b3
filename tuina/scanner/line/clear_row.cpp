// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/clear_row.hpp"

#include <algorithm>
#include <cstring>

#include "tuina/scanner/line/clear_row_avx2.hpp"
#include "tuina/scanner/line/clear_row_steps.hpp"

namespace tuina::scanner {
namespace {

float sum_of_eight(const std::uint8_t* pixels) {
  int sum = 0;
  for (int i = 0; i < 8; ++i) sum += pixels[i];
  return static_cast<float>(sum);
}

// Features around the brightest pixel of a row, which has the margin.
RowFacts<float> facts_of(const std::uint8_t* row, int at, const RowRule& rule) {
  const std::uint8_t* peak = row + at;
  const auto rival = std::max(largest(row + rule.first, at - rule.beside_px - rule.first + 1),
                              largest(peak + rule.beside_px, rule.last - at - rule.beside_px + 1));
  int spike = 0;
  for (int i = -LineKernel::before; i < LineKernel::taps - LineKernel::before; ++i) {
    spike = std::max(spike, peak[i] - std::max(peak[i - 1], peak[i + 1]));
  }
  return {.most = static_cast<float>(*peak),
          .neighbour = static_cast<float>(std::max(peak[-1], peak[1])),
          .beside_sum = std::max(sum_of_eight(peak - rule.beside_px - 7),
                                 sum_of_eight(peak + rule.beside_px)),
          .rival = static_cast<float>(rival),
          .spike = static_cast<float>(spike)};
}

void classify(const RowBatch& rows, const RowRule& rule, int /*hint*/, BatchView& seen) noexcept {
  const int count = rule.last - rule.first + 1;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint8_t* begin = rows[i] + rule.first;
    const std::uint8_t most = largest(begin, count);
    const auto* found =
        static_cast<const std::uint8_t*>(std::memchr(begin, most, static_cast<std::size_t>(count)));
    seen.brightest[i] = static_cast<int>(found - rows[i]);
    bool clear = false;
    if (most >= rule.min_dn && rule.has_margin(seen.brightest[i])) {
      test_clear(facts_of(rows[i], seen.brightest[i], rule), rule, clear);
    }
    seen.view[i] = clear                ? RowView::one_line
                   : most < rule.min_dn ? RowView::dark
                                        : RowView::in_doubt;
  }
}

void weigh(const std::uint8_t* const* rows, const Wholes& first, const Wholes& phase,
           const LineKernel& kernel, Wholes& offset, Wholes& height) {
  offset = Wholes{};
  height = Wholes{};
  for (std::size_t k = 0; k < group; ++k) {
    const std::uint8_t* pixels = rows[k] + first[k];
    const auto& weights = kernel.whole_of_phase[static_cast<std::size_t>(phase[k])];
    for (std::size_t i = 0; i < LineKernel::taps; ++i) {
      offset[k] += pixels[i] * weights.offset[i];
      height[k] += pixels[i] * weights.height[i];
    }
  }
}

void walk(const RowBatch& rows, const LineKernel& kernel, int steps, LineWalk& walk) noexcept {
  walk_with(weigh, rows, kernel, steps, walk);
}

constexpr RowReader plain_reader = {classify, walk};

}  // namespace

const RowReader& plain_row_reader() noexcept {
  return plain_reader;
}

const RowReader& row_reader() noexcept {
  static const RowReader* const best = avx2_row_reader() ? avx2_row_reader() : &plain_reader;
  return *best;
}

}  // namespace tuina::scanner
