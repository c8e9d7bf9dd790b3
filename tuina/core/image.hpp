// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tuina {

/// A picture in memory, row by row, channels interleaved, 8 or 16 bits per sample.
template <typename Sample>
struct BasicImage {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<Sample> data;

  BasicImage() = default;
  /// Black, w x h pixels of c samples.
  BasicImage(int w, int h, int c = 1)
      : width(w),
        height(h),
        channels(c),
        data(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) *
             static_cast<std::size_t>(c)) {}

  /// @{
  /// First sample of a row.
  [[nodiscard]] Sample* row(int y) {
    return data.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width * channels);
  }
  [[nodiscard]] const Sample* row(int y) const {
    return data.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width * channels);
  }
  /// @}
};

/// @{
/// Pictures with 8 and 16 bits a sample.
using Image = BasicImage<std::uint8_t>;
using Image16 = BasicImage<std::uint16_t>;
/// @}

/// One channel of a picture that is owned elsewhere; `stride` is the number of samples between
/// rows.
template <typename Sample>
struct BasicImageView {
  const Sample* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;

  BasicImageView() = default;
  /// Of samples that must outlive it; `row_stride` is the number of samples from row to row.
  BasicImageView(const Sample* samples, int w, int h, std::ptrdiff_t row_stride)
      : data(samples), width(w), height(h), stride(row_stride) {}
  /// Of a whole picture, which must outlive it.
  BasicImageView(const BasicImage<Sample>& grey)  // NOLINT(google-explicit-constructor)
      : data(grey.data.data()), width(grey.width), height(grey.height), stride(grey.width) {}

  /// First sample of a row.
  [[nodiscard]] const Sample* row(int y) const { return data + y * stride; }
};

/// @{
/// Views of grey pictures with 8 and 16 bits a sample.
using ImageView = BasicImageView<std::uint8_t>;
using ImageView16 = BasicImageView<std::uint16_t>;
/// @}

}  // namespace tuina
