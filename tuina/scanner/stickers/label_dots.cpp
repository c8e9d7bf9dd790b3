// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/stickers/label_dots.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "tuina/core/geometry.hpp"

namespace tuina::scanner {
namespace {

// In standard deviations of the line, where its light is a tenth.
constexpr double beside_line = 2.0;
constexpr double min_chroma_dn = 12.0;  // three times the noise of a mean of nine pixels
constexpr double min_purity = 0.5;      // skin has 0.25 to 0.45

/// Hue range in degrees of a sticker in room and laser light. Skin lies between 10 and 30.
struct HueRange {
  StickerColour colour;
  const char* name;
  double low, high;
};
constexpr std::array<HueRange, 4> hues = {{{StickerColour::yellow, "yellow", 30.0, 75.0},
                                           {StickerColour::green, "green", 85.0, 165.0},
                                           {StickerColour::blue, "blue", 185.0, 255.0},
                                           {StickerColour::magenta, "magenta", 280.0, 350.0}}};

/// Mean of nine pixels.
Vector3 colour_at(const Image& frame, int row, int column) {
  Vector3 sum = Vector3::Zero();
  for (int y = row - 1; y <= row + 1; ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      const std::uint8_t* pixel = frame.row(y) + 3 * x;
      sum += Vector3(pixel[0], pixel[1], pixel[2]);
    }
  }
  return sum / 9.0;
}

std::optional<StickerColour> colour_of(const Vector3& rgb) {
  const double most = rgb.maxCoeff();
  const double chroma = most - rgb.minCoeff();
  if (chroma < min_chroma_dn || chroma < min_purity * most) return {};
  double sixth = 0.0;  // hue in sixths of the circle
  if (most == rgb.x()) {
    sixth = (rgb.y() - rgb.z()) / chroma;
  } else if (most == rgb.y()) {
    sixth = 2.0 + (rgb.z() - rgb.x()) / chroma;
  } else {
    sixth = 4.0 + (rgb.x() - rgb.y()) / chroma;
  }
  const double hue = std::fmod(60.0 * sixth + 360.0, 360.0);
  for (const HueRange& range : hues) {
    if (hue >= range.low && hue <= range.high) return range.colour;
  }
  return {};
}

}  // namespace

const char* name_of(StickerColour colour) {
  return hues[static_cast<std::size_t>(colour)].name;
}

std::optional<StickerColour> sticker_colour(std::string_view name) {
  for (const HueRange& range : hues) {
    if (name == range.name) return range.colour;
  }
  return {};
}

std::vector<LabelDot> find_label_dots(const Image& frame, const LaserLine& line) {
  assert(frame.channels == 3);
  const int aside = static_cast<int>(std::ceil(beside_line * line.width_px)) + 1;
  std::vector<LabelDot> dots;
  for (const LinePoint& point : line.points) {
    const auto column = static_cast<int>(std::lround(point.column_px));
    if (point.row < 1 || point.row + 1 >= frame.height || column - aside < 1 ||
        column + aside + 1 >= frame.width) {
      continue;
    }
    const auto left = colour_of(colour_at(frame, point.row, column - aside));
    if (!left || left != colour_of(colour_at(frame, point.row, column + aside))) continue;
    dots.push_back({*left, point.row, static_cast<double>(point.column_px)});
  }
  return dots;
}

}  // namespace tuina::scanner
