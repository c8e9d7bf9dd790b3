// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// The rows of a picture as numbers in which a laser line stands out, one at a time and so without
/// a second picture in memory. Clipped pixels keep the saturation value, unless what is taken off
/// is nearly clipped there itself: then they say nothing of a line. `Pixel`: 8 or 16 bits;
/// `saturated_dn` as in `LineOptions`.
template <typename Pixel>
class LineRows {
 public:
  /// Of a grey picture, less a dark one of the same size, or of none.
  LineRows(BasicImageView<Pixel> image, BasicImageView<Pixel> dark, double saturated_dn);
  /// The red of three or four channels, less what it would be without a red laser: green times
  /// `red_to_green`. The picture must outlive it.
  LineRows(const BasicImage<Pixel>& colours, float red_to_green, double saturated_dn);

  [[nodiscard]] int width() const { return image_.width; }
  [[nodiscard]] int height() const { return image_.height; }
  [[nodiscard]] float saturated_dn() const { return saturated_dn_; }
  /// True when nothing is taken off: the rows are those of `image()`.
  [[nodiscard]] bool plain() const { return dark_.data == nullptr && channels_ == 1; }
  [[nodiscard]] const BasicImageView<Pixel>& image() const { return image_; }
  /// One row; valid until the next is asked for.
  [[nodiscard]] const float* row(int y);

 private:
  BasicImageView<Pixel> image_;  // interleaved where there are several channels
  BasicImageView<Pixel> dark_;
  int channels_ = 1;
  float red_to_green_ = 0.0F;
  float saturated_dn_;
  std::vector<float> row_;
};

/// `find_laser_line` in such rows.
template <typename Pixel>
[[nodiscard]] LaserLine find_laser_line(LineRows<Pixel> rows, const LineOptions& options);

}  // namespace tuina::scanner
