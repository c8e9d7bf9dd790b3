// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/clear_row_avx2.hpp"

#include <algorithm>
#include <cstring>

#include "tuina/scanner/line/clear_row_steps.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

// Attribute per function instead of a file-wide flag: inline functions shared with other files must
// run on every processor.
#define TUINA_AVX2 __attribute__((target("avx2")))

namespace tuina::scanner {
namespace {

constexpr int block = 32;          // pixels per register
constexpr int window = 2 * block;  // columns in which the lines of a batch are expected

TUINA_AVX2 inline __m256i load(const std::uint8_t* pixels) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(pixels));
}

// Broadcasts the largest byte.
TUINA_AVX2 inline __m256i largest_everywhere(__m256i bytes) {
  // The minimum of eight 16-bit numbers is one instruction, so complements are used.
  const __m128i half =
      _mm_max_epu8(_mm256_castsi256_si128(bytes), _mm256_extracti128_si256(bytes, 1));
  const __m128i less = _mm_xor_si128(half, _mm_set1_epi8(-1));
  const __m128i least = _mm_minpos_epu16(_mm_min_epu8(less, _mm_srli_epi16(less, 8)));
  return _mm256_xor_si256(_mm256_broadcastb_epi8(least), _mm256_set1_epi8(-1));
}

TUINA_AVX2 inline int largest_of(__m256i bytes) {
  return _mm256_cvtsi256_si32(largest_everywhere(bytes)) & 255;
}

TUINA_AVX2 inline std::uint64_t places_of(__m256i wanted, __m256i pixels) {
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(pixels, wanted)));
}

// Mask: zero within `beside_px` of the line, else ones.
struct Gap {
  std::array<std::uint8_t, 3 * window> bytes = {};
  int nearest = 0;  // columns from the line to the first one of the gap

  // The mask beginning `after` columns after the line.
  [[nodiscard]] const std::uint8_t* from(int after) const {
    return bytes.data() + window + nearest + after;
  }
};

// Constexpr: loading bytes just written would stall.
constexpr int max_beside_px = window / 4;
constexpr auto gaps = [] {
  std::array<Gap, max_beside_px + 1> all;
  for (int beside_px = 1; beside_px <= max_beside_px; ++beside_px) {
    Gap& gap = all[static_cast<std::size_t>(beside_px)];
    gap.nearest = beside_px - 1;
    gap.bytes.fill(255);
    for (int i = window; i <= window + 2 * gap.nearest; ++i)
      gap.bytes[static_cast<std::size_t>(i)] = 0;
  }
  return all;
}();

// Lane-wise maximum over the rows of a group, left and right of the window.
TUINA_AVX2 inline __m256i max_outside(const std::uint8_t* const* rows, int first, int begin,
                                      int last) {
  __m256i most[4] = {};
  // Prefetches the next group of rows when the picture comes from main memory.
  const std::uint8_t* ahead = rows[0] + static_cast<std::ptrdiff_t>(group) * (rows[1] - rows[0]);
  const auto take = [&](int x) __attribute__((target("avx2"), always_inline)) {
#pragma GCC unroll 8
    for (std::size_t i = 0; i < group; ++i) {
      most[i % 4] = _mm256_max_epu8(most[i % 4], load(rows[i] + x));
      if (i % 2 == 0) __builtin_prefetch(ahead + block * i);
    }
    ahead += group * block;
  };
  for (int x = first; x < begin; x += block) take(x);
  // The last register ends with the span and may overlap.
  for (int x = begin + window; x + block <= last; x += block) take(x);
  take(last + 1 - block);
  return _mm256_max_epu8(_mm256_max_epu8(most[0], most[1]), _mm256_max_epu8(most[2], most[3]));
}

// One pass over a group whose lines lie well inside one window: true when every row shows one line,
// `dark` when none does; otherwise undecided, since rivals and spikes are pooled over the rows.
TUINA_AVX2 inline bool all_show_one_line(const std::uint8_t* const* rows, const RowRule& rule,
                                         int begin, const Gap& gap, int* brightest, bool& dark) {
  const int beside_px = rule.beside_px;
  const auto nearest = static_cast<unsigned>(gap.nearest);
  __m256i rivals = max_outside(rows, rule.first, begin, rule.last);
  __m256i spikes = _mm256_setzero_si256();
  __m256i inside = _mm256_setzero_si256();
  alignas(32) std::array<std::int32_t, group> around;
  alignas(32) std::array<std::int32_t, group> beside;
  bool within = true;
  for (std::size_t i = 0; i < group; ++i) {
    const std::uint8_t* from = rows[i] + begin;
    const __m256i pixels[2] = {load(from), load(from + block)};
    const __m256i both = _mm256_max_epu8(pixels[0], pixels[1]);
    const __m256i wanted = largest_everywhere(both);
    const int at =
        __builtin_ctzll(places_of(wanted, pixels[0]) | places_of(wanted, pixels[1]) << block);
    brightest[i] = begin + at;
    within &= static_cast<unsigned>(at) - nearest <= window - 1 - 2 * nearest;
    inside = _mm256_max_epu8(inside, both);
    const std::uint8_t* keep = gap.from(-at);
    rivals =
        _mm256_max_epu8(rivals, _mm256_max_epu8(_mm256_and_si256(pixels[0], load(keep)),
                                                _mm256_and_si256(pixels[1], load(keep + block))));

    const std::uint8_t* peak = from + at;
    std::memcpy(&around[i], peak - 1, sizeof around[i]);
    const __m128i sides =
        _mm_unpacklo_epi64(_mm_loadu_si64(peak - beside_px - 7), _mm_loadu_si64(peak + beside_px));
    const __m128i sums = _mm_sad_epu8(sides, _mm_setzero_si128());
    beside[i] = _mm_cvtsi128_si32(_mm_max_epi32(sums, _mm_unpackhi_epi64(sums, sums)));
    const std::uint8_t* taps = peak - LineKernel::before;
    spikes = _mm256_max_epu8(
        spikes, _mm256_subs_epu8(load(taps), _mm256_max_epu8(load(taps - 1), load(taps + 1))));
  }
  const int rival = largest_of(rivals);
  dark = std::max(rival, largest_of(inside)) < rule.min_dn;
  Wholes byte;
  std::memcpy(&byte, around.data(), sizeof byte);
  Wholes sum;
  std::memcpy(&sum, beside.data(), sizeof sum);
  const Wholes left = byte & 255;
  const Wholes right = byte >> 16 & 255;
  const Wholes most = byte >> 8 & 255;
  Wholes clear;
  test_clear(
      RowFacts<Floats>{.most = __builtin_convertvector(most, Floats),
                       .neighbour = __builtin_convertvector(left > right ? left : right, Floats),
                       .beside_sum = __builtin_convertvector(sum, Floats),
                       .rival = Floats{} + static_cast<float>(rival),
                       .spike = Floats{} + static_cast<float>(largest_of(spikes))},
      rule, clear);
  clear &= (most >= rule.min_dn) & (most >= rival);
  return within && _mm256_movemask_epi8(reinterpret_cast<__m256i>(clear)) == -1;
}

TUINA_AVX2 void classify(const RowBatch& rows, const RowRule& rule, int hint,
                         BatchView& seen) noexcept {
  // The window begins whole registers after the span's first column, and all its columns have
  // margin and a register to the right.
  const int room = rule.last - rule.first + 1 - window - 2 * block;
  if (room >= block && rule.beside_px <= max_beside_px && rule.margin_px() <= block) {
    const int wanted = (hint - rule.first - block / 2) / block;
    const int begin = rule.first + block * std::clamp(wanted, 1, room / block);
    const Gap& gap = gaps[static_cast<std::size_t>(rule.beside_px)];
    bool all_clear = true;
    bool all_dark = true;
    for (std::size_t i = 0; i < rows.size(); i += group) {
      bool dark = false;
      all_clear &=
          all_show_one_line(rows.data() + i, rule, begin, gap, seen.brightest.data() + i, dark);
      all_dark &= dark;
    }
    if (all_dark) return seen.view.fill(RowView::dark);
    if (all_clear) return seen.view.fill(RowView::one_line);
  }
  plain_row_reader().classify(rows, rule, hint, seen);
}

TUINA_AVX2 inline __m256i words(const std::int16_t* weights) {
  return _mm256_load_si256(reinterpret_cast<const __m256i*>(weights));
}

// Horizontal sums of four registers, per half.
TUINA_AVX2 inline __m256i sums_of_four(const __m256i* parts) {
  return _mm256_hadd_epi32(_mm256_hadd_epi32(parts[0], parts[1]),
                           _mm256_hadd_epi32(parts[2], parts[3]));
}

TUINA_AVX2 inline __m256i sums_of_eight(const __m256i* parts) {
  const __m256i low = sums_of_four(parts);
  const __m256i high = sums_of_four(parts + 4);
  return _mm256_add_epi32(_mm256_permute2x128_si256(low, high, 0x20),
                          _mm256_permute2x128_si256(low, high, 0x31));
}

TUINA_AVX2 inline void weigh(const std::uint8_t* const* rows, const Wholes& first,
                             const Wholes& phase, const LineKernel& kernel, Wholes& offset,
                             Wholes& height) {
  __m256i offsets[group];
  __m256i heights[group];
  for (std::size_t i = 0; i < group; ++i) {
    const auto* pixels = reinterpret_cast<const __m128i*>(rows[i] + first[i]);
    const auto& weights = kernel.whole_of_phase[static_cast<std::size_t>(phase[i])];
    const __m256i left = _mm256_cvtepu8_epi16(_mm_loadu_si128(pixels));
    const __m256i right = _mm256_cvtepu8_epi16(_mm_loadu_si128(pixels + 1));
    offsets[i] = _mm256_add_epi32(_mm256_madd_epi16(left, words(weights.offset.data())),
                                  _mm256_madd_epi16(right, words(weights.offset.data() + 16)));
    heights[i] = _mm256_add_epi32(_mm256_madd_epi16(left, words(weights.height.data())),
                                  _mm256_madd_epi16(right, words(weights.height.data() + 16)));
  }
  offset = reinterpret_cast<Wholes>(sums_of_eight(offsets));
  height = reinterpret_cast<Wholes>(sums_of_eight(heights));
}

TUINA_AVX2 void walk(const RowBatch& rows, const LineKernel& kernel, int steps,
                     LineWalk& walk) noexcept {
  walk_with(weigh, rows, kernel, steps, walk);
}

constexpr RowReader reader = {classify, walk};

}  // namespace

const RowReader* avx2_row_reader() noexcept {
  return __builtin_cpu_supports("avx2") ? &reader : nullptr;
}

}  // namespace tuina::scanner

#else

namespace tuina::scanner {

const RowReader* avx2_row_reader() noexcept {
  return nullptr;
}

}  // namespace tuina::scanner

#endif
