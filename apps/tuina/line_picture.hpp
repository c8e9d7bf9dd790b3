// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "tuina/core/image.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::app {

/// The first channel of a picture in grey at half its light, the line in red over it. `bits`: of a
/// sample, 8 or 16.
template <typename Sample>
[[nodiscard]] Image draw_line_over(const BasicImage<Sample>& image, int bits,
                                   const scanner::LaserLine& line) {
  Image picture(image.width, image.height, 3);
  const int divisor = bits > 8 ? 257 * 2 : 2;
  for (int y = 0; y < picture.height; ++y) {
    const Sample* from = image.row(y);
    std::uint8_t* to = picture.row(y);
    for (int x = 0; x < picture.width; ++x) {
      const auto grey = static_cast<std::uint8_t>(from[x * image.channels] / divisor);
      std::fill_n(to + 3 * x, 3, grey);
    }
  }
  for (const scanner::LinePoint& point : line.points) {
    const int x = std::clamp(static_cast<int>(std::lround(point.column_px)), 0, picture.width - 1);
    std::uint8_t* pixel = picture.row(point.row) + 3 * x;
    pixel[0] = 255;
    pixel[1] = 60;
    pixel[2] = 40;
  }
  return picture;
}

}  // namespace tuina::app
