// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/clear_row.hpp"

#include <algorithm>
#include <cstring>

#include "tuina/scanner/clear_row_avx2.hpp"
#include "tuina/scanner/clear_row_steps.hpp"

namespace tuina::scanner {
namespace {

int brightest(const std::uint8_t* pixels, int count) {
  std::uint8_t most = 0;
  for (int i = 0; i < count; ++i) most = std::max(most, pixels[i]);
  return most;
}

int sum_of_eight(const std::uint8_t* pixels) {
  int sum = 0;
  for (int i = 0; i < 8; ++i) sum += pixels[i];
  return sum;
}

RowFacts facts_of(const std::uint8_t* row, const RowSpan& span) {
  RowFacts facts;
  const int count = span.last - span.first + 1;
  facts.most = brightest(row + span.first, count);
  const void* found = std::memchr(row + span.first, facts.most, static_cast<std::size_t>(count));
  facts.at = static_cast<int>(static_cast<const std::uint8_t*>(found) - row);
  if (facts.most < span.least_dn || !span.has_margin(facts.at)) return facts;
  const std::uint8_t* peak = row + facts.at;
  facts.left_sum = sum_of_eight(peak - span.beside_px - 7);
  facts.right_sum = sum_of_eight(peak + span.beside_px);
  facts.neighbour = std::max(peak[-1], peak[1]);
  facts.rival =
      std::max(brightest(row + span.first, facts.at - span.beside_px - span.first + 1),
               brightest(peak + span.beside_px, span.last - facts.at - span.beside_px + 1));
  for (int i = -LineKernel::before; i < LineKernel::taps - LineKernel::before; ++i) {
    facts.spike = std::max(facts.spike, peak[i] - std::max(peak[i - 1], peak[i + 1]));
  }
  return facts;
}

LineSums weigh(const std::uint8_t* pixels, const LineKernel::WholeWeights& weights) {
  LineSums sums;
  for (std::size_t i = 0; i < LineKernel::taps; ++i) {
    sums.offset += pixels[i] * weights.offset[i];
    sums.height += pixels[i] * weights.height[i];
  }
  return sums;
}

void read(const RowBatch& rows, const RowSpan& span, int /*hint*/,
          std::array<RowFacts, rows_at_once>& facts) noexcept {
  for (std::size_t i = 0; i < rows.size(); ++i) facts[i] = facts_of(rows[i], span);
}

void walk(const RowBatch& rows, const LineKernel& kernel, int steps, LineWalk& walk) noexcept {
  walk_with(weigh, rows, kernel, steps, walk);
}

constexpr RowReader plain = {read, walk};

}  // namespace

const RowReader& plain_row_reader() noexcept {
  return plain;
}

const RowReader& row_reader() noexcept {
  static const RowReader* const best = avx2_row_reader() ? avx2_row_reader() : &plain;
  return *best;
}

}  // namespace tuina::scanner
