// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_rows.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "tuina/scanner/line/twice.hpp"

namespace tuina::scanner {
namespace {

// Least share of the range above what is taken off at which a clipped pixel tells of a line.
constexpr float min_room = 0.25F;

// Simple loops, which the compiler can vectorise. Each keeps the most light that was seen.
template <typename Pixel>
[[gnu::always_inline]] inline float take(const Pixel* pixels, int count, float* __restrict row) {
  Pixel most = 0;
  for (int x = 0; x < count; ++x) {
    row[x] = static_cast<float>(pixels[x]);
    most = pixels[x] > most ? pixels[x] : most;
  }
  return static_cast<float>(most);
}

template <typename Pixel>
[[gnu::always_inline]] inline float take_less(const Pixel* pixels, const Pixel* off, int count,
                                              float* __restrict row) {
  Pixel most = 0;
  for (int x = 0; x < count; ++x) {
    row[x] = static_cast<float>(pixels[x] - off[x]);
    most = pixels[x] > most ? pixels[x] : most;
  }
  return static_cast<float>(most);
}

template <int channels, typename Pixel>
[[gnu::always_inline]] inline float take_red(const Pixel* pixels, int count, float ratio,
                                             float saturated, float* __restrict row) {
  // The colours are parted first, some pixels at a time: each loop becomes vectors then, both in
  // one do not.
  constexpr std::size_t some = 256;
  std::array<Pixel, some> red;
  std::array<Pixel, some> green;
  Pixel most = 0;
  for (std::size_t from = 0; from < static_cast<std::size_t>(count); from += some) {
    const std::size_t here = std::min(some, static_cast<std::size_t>(count) - from);
    const Pixel* at = pixels + channels * from;
    for (std::size_t x = 0; x < here; ++x) {
      red[x] = at[channels * x];
      green[x] = at[channels * x + 1];
    }
    for (std::size_t x = 0; x < here; ++x) {
      const float scene = ratio * static_cast<float>(green[x]);
      row[from + x] = static_cast<float>(red[x]) - (scene < saturated ? scene : saturated);
      most = red[x] > most ? red[x] : most;
    }
  }
  return static_cast<float>(most);
}

using Pixel8 = std::uint8_t;
using Pixel16 = std::uint16_t;

TUINA_TWICE float fill(const Pixel8* pixels, int count, float* row) {
  return take(pixels, count, row);
}
TUINA_TWICE float fill(const Pixel16* pixels, int count, float* row) {
  return take(pixels, count, row);
}
TUINA_TWICE float fill_less(const Pixel8* pixels, const Pixel8* off, int count, float* row) {
  return take_less(pixels, off, count, row);
}
TUINA_TWICE float fill_less(const Pixel16* pixels, const Pixel16* off, int count, float* row) {
  return take_less(pixels, off, count, row);
}
TUINA_TWICE float fill_red(const Pixel8* pixels, int channels, int count, float ratio,
                           float saturated, float* row) {
  return channels == 3 ? take_red<3>(pixels, count, ratio, saturated, row)
                       : take_red<4>(pixels, count, ratio, saturated, row);
}
TUINA_TWICE float fill_red(const Pixel16* pixels, int channels, int count, float ratio,
                           float saturated, float* row) {
  return channels == 3 ? take_red<3>(pixels, count, ratio, saturated, row)
                       : take_red<4>(pixels, count, ratio, saturated, row);
}

template <typename Pixel>
float clipped_from(double saturated_dn) {
  return saturated_dn > 0.0 ? static_cast<float>(saturated_dn)
                            : static_cast<float>(std::numeric_limits<Pixel>::max());
}

}  // namespace

template <typename Pixel>
LineRows<Pixel>::LineRows(BasicImageView<Pixel> image, BasicImageView<Pixel> dark,
                          double saturated_dn)
    : image_(image),
      dark_(dark),
      saturated_dn_(clipped_from<Pixel>(saturated_dn)),
      row_(static_cast<std::size_t>(image.width)) {}

template <typename Pixel>
LineRows<Pixel>::LineRows(const BasicImage<Pixel>& colours, float red_to_green, double saturated_dn)
    : image_(colours.data.data(), colours.width, colours.height,
             static_cast<std::ptrdiff_t>(colours.width) * colours.channels),
      channels_(colours.channels),
      red_to_green_(red_to_green),
      saturated_dn_(clipped_from<Pixel>(saturated_dn)),
      row_(static_cast<std::size_t>(colours.width)) {}

template <typename Pixel>
const float* LineRows<Pixel>::row(int y) {
  const Pixel* pixels = image_.row(y);
  const int count = image_.width;
  float most = 0.0F;
  if (channels_ > 1) {
    most = fill_red(pixels, channels_, count, red_to_green_, saturated_dn_, row_.data());
  } else if (dark_.data != nullptr) {
    most = fill_less(pixels, dark_.row(y), count, row_.data());
  } else {
    most = fill(pixels, count, row_.data());
  }
  if (most < saturated_dn_) return row_.data();
  for (int x = 0; x < count; ++x) {
    const auto value = static_cast<float>(pixels[channels_ * x]);
    float& light = row_[static_cast<std::size_t>(x)];
    if (value >= saturated_dn_ && value - light <= (1.0F - min_room) * saturated_dn_)
      light = saturated_dn_;
  }
  return row_.data();
}

template class LineRows<std::uint8_t>;
template class LineRows<std::uint16_t>;

}  // namespace tuina::scanner
