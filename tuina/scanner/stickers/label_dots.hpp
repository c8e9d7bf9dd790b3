// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// Sticker colours, far from every skin in hue or saturation.
enum class StickerColour : std::uint8_t { yellow, green, blue, magenta };
inline constexpr std::array<StickerColour, 4> sticker_colours = {
    StickerColour::yellow, StickerColour::green, StickerColour::blue, StickerColour::magenta};
/// Name of a colour, as options have it.
[[nodiscard]] const char* name_of(StickerColour colour);
/// Colour of a name; nothing for any other word.
[[nodiscard]] std::optional<StickerColour> sticker_colour(std::string_view name);

/// A point of the laser line on a sticker.
struct LabelDot {
  StickerColour colour = StickerColour::blue;
  int row = 0;
  double column_px = 0.0;
};

/// [thesis] Algorithm 1 on one colour frame: a laser point counts when the picture beside the line
/// has one sticker colour on both sides. `frame`: three channels, red first.
[[nodiscard]] std::vector<LabelDot> find_label_dots(const Image& frame, const LaserLine& line);

}  // namespace tuina::scanner
