// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/clear_row_avx2.hpp"

#include <algorithm>

#include "tuina/scanner/clear_row_steps.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

// The attribute of each function, not a flag of the whole file: what this file shares with others
// inline must run on every processor.
#define TUINA_AVX2 __attribute__((target("avx2")))

namespace tuina::scanner {
namespace {

constexpr int block = 32;  // pixels in a register

TUINA_AVX2 inline __m256i load(const std::uint8_t* pixels) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(pixels));
}

TUINA_AVX2 inline int largest_of(__m256i bytes) {
  // The smallest of eight 16-bit numbers is one instruction, so the complements go through it.
  const __m128i half =
      _mm_max_epu8(_mm256_castsi256_si128(bytes), _mm256_extracti128_si256(bytes, 1));
  const __m128i less = _mm_xor_si128(half, _mm_set1_epi8(-1));
  const __m128i pairs = _mm_min_epu8(less, _mm_srli_epi16(less, 8));
  return 255 - (_mm_cvtsi128_si32(_mm_minpos_epu16(pairs)) & 255);
}

TUINA_AVX2 inline int sum_of_eight(const std::uint8_t* pixels) {
  const __m128i eight = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(pixels));
  return _mm_cvtsi128_si32(_mm_sad_epu8(eight, _mm_setzero_si128()));
}

TUINA_AVX2 inline unsigned places_of(__m256i wanted, __m256i pixels) {
  return static_cast<unsigned>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(pixels, wanted)));
}

// Three registers of a row in which the line is expected, and how the rest of the span is covered
// by whole ones.
constexpr int window = 3 * block;

// The first column of the window; the span must hold at least `window + block` columns.
int window_at(const RowSpan& span, int hint) {
  const int beside = span.last - span.first + 1 - window;
  // Right of the window there must be nothing, or enough for a register of its own.
  const int most = beside % block == 0 ? beside / block : beside / block - 1;
  const int wanted = (hint - window / 2 + block / 2 - span.first) / block;
  return span.first + block * std::clamp(wanted, 0, most);
}

// Ones but for the columns nearer to the line than `beside_px`, which are zeros.
struct Gap {
  std::array<std::uint8_t, 3 * window> bytes;
  int nearest;  // columns from the line to the first one of the gap

  explicit Gap(const RowSpan& span) : nearest(span.beside_px - 1) {
    bytes.fill(255);
    std::fill_n(bytes.begin() + window, 2 * nearest + 1, std::uint8_t{0});
  }
  // Begins with the column that is `after` columns after the line.
  [[nodiscard]] const std::uint8_t* from(int after) const {
    return bytes.data() + window + nearest + after;
  }
};

// False when the brightest pixel is not in the window, or too near its ends to tell what else is.
TUINA_AVX2 inline bool facts_of(const std::uint8_t* row, const RowSpan& span, int begin,
                                const Gap& gap, RowFacts& facts) {
  const __m256i pixels[3] = {load(row + begin), load(row + begin + block),
                             load(row + begin + 2 * block)};
  facts.most = largest_of(_mm256_max_epu8(_mm256_max_epu8(pixels[0], pixels[1]), pixels[2]));
  __m256i others = _mm256_setzero_si256();
  for (int x = span.first; x < begin; x += block) others = _mm256_max_epu8(others, load(row + x));
  for (int x = begin + window; x + block <= span.last; x += block) {
    others = _mm256_max_epu8(others, load(row + x));
  }
  if (begin + window <= span.last) {
    others = _mm256_max_epu8(others, load(row + span.last - block + 1));
  }
  const __m256i wanted = _mm256_set1_epi8(static_cast<char>(facts.most));
  const std::uint64_t first =
      places_of(wanted, pixels[0]) | std::uint64_t{places_of(wanted, pixels[1])} << block;
  const unsigned third = places_of(wanted, pixels[2]);
  facts.at = begin + (first != 0 ? __builtin_ctzll(first) : 2 * block + __builtin_ctz(third));

  const std::uint8_t* keep = gap.from(begin - facts.at);
  for (int i = 0; i < 3; ++i) {
    others = _mm256_max_epu8(others, _mm256_and_si256(pixels[i], load(keep + i * block)));
  }
  facts.rival = largest_of(others);
  if (facts.rival > facts.most) return false;
  if (facts.most < span.least_dn || !span.has_margin(facts.at)) return true;
  if (facts.at - begin < gap.nearest || begin + window - 1 - facts.at < gap.nearest) return false;

  const std::uint8_t* peak = row + facts.at;
  facts.left_sum = sum_of_eight(peak - span.beside_px - 7);
  facts.right_sum = sum_of_eight(peak + span.beside_px);
  facts.neighbour = std::max(peak[-1], peak[1]);
  const std::uint8_t* taps = peak - LineKernel::before;
  facts.spike =
      largest_of(_mm256_subs_epu8(load(taps), _mm256_max_epu8(load(taps - 1), load(taps + 1))));
  return true;
}

TUINA_AVX2 inline __m256i words(const std::int16_t* weights) {
  return _mm256_load_si256(reinterpret_cast<const __m256i*>(weights));
}

TUINA_AVX2 inline LineSums weigh(const std::uint8_t* pixels,
                                 const LineKernel::WholeWeights& weights) {
  const __m256i pixels_of[2] = {
      _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(pixels))),
      _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(pixels + 16)))};
  const __m256i offset =
      _mm256_add_epi32(_mm256_madd_epi16(pixels_of[0], words(weights.offset.data())),
                       _mm256_madd_epi16(pixels_of[1], words(weights.offset.data() + 16)));
  const __m256i height =
      _mm256_add_epi32(_mm256_madd_epi16(pixels_of[0], words(weights.height.data())),
                       _mm256_madd_epi16(pixels_of[1], words(weights.height.data() + 16)));
  const __m256i pairs = _mm256_hadd_epi32(offset, height);
  const __m128i fours =
      _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
  const __m128i sums = _mm_hadd_epi32(fours, fours);
  return {_mm_cvtsi128_si32(sums), _mm_extract_epi32(sums, 1)};
}

TUINA_AVX2 void read(const RowBatch& rows, const RowSpan& span, int hint,
                     std::array<RowFacts, rows_at_once>& facts) noexcept {
  if (span.last - span.first + 1 < window + block || 2 * span.beside_px > window) {
    return plain_row_reader().read(rows, span, hint, facts);
  }
  const int begin = window_at(span, hint);
  const Gap gap(span);
  bool found = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    found &= facts_of(rows[i], span, begin, gap, facts[i]);
  }
  if (!found) plain_row_reader().read(rows, span, hint, facts);
}

TUINA_AVX2 void walk(const RowBatch& rows, const LineKernel& kernel, int steps,
                     LineWalk& walk) noexcept {
  walk_with(weigh, rows, kernel, steps, walk);
}

constexpr RowReader reader = {read, walk};

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
