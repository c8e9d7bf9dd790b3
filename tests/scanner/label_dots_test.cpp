// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/stickers/label_dots.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/scanner/stickers/sticker_watch.hpp"

namespace tuina::scanner {
namespace {

constexpr int line_column = 48;

/// Skin in the light of a room, a sticker of one colour between two columns in the lower half, and
/// the laser down the middle.
Image frame(std::array<int, 3> sticker, int from, int to) {
  Image image(96, 64, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const bool on_sticker = y >= 32 && x >= from && x <= to;
      const std::array<int, 3> matt = on_sticker ? sticker : std::array<int, 3>{60, 45, 36};
      const double u = (x - line_column) / 2.5;
      for (std::size_t k = 0; k < 3; ++k) {
        const double laser = k == 0 ? 150.0 * std::exp(-0.5 * u * u) : 0.0;
        image.row(y)[3 * x + static_cast<int>(k)] =
            static_cast<std::uint8_t>(std::min(255.0, matt[k] + laser));
      }
    }
  }
  return image;
}

LaserLine line() {
  LaserLine found{.points = {}, .width_px = 2.5};
  for (int row = 0; row < 64; ++row) {
    found.points.push_back({.row = row, .column_px = line_column, .amplitude_dn = 150.0F});
  }
  return found;
}

/// A camera that gives one grey frame.
class GreyCamera final : public Camera {
 public:
  Result<Frame> next_frame(double) override {
    return Frame{.time_s = 0.0, .image = Image(640, 480), .dark = {}};
  }
};

}  // namespace

TEST_CASE("a laser dot counts when a sticker is on both sides of it, [thesis] Algorithm 1") {
  const std::array<int, 3> blue = {10, 25, 58};
  const auto dots = find_label_dots(frame(blue, 36, 60), line());
  REQUIRE(dots.size() > 25);
  for (const LabelDot& dot : dots) {
    CHECK(dot.colour == StickerColour::blue);
    CHECK(dot.row >= 32);
    CHECK(dot.column_px == line_column);
  }
  // The line runs beside the sticker, or along its edge.
  CHECK(find_label_dots(frame(blue, 60, 90), line()).empty());
  CHECK(find_label_dots(frame(blue, 48, 72), line()).empty());
}

TEST_CASE("each colour of sticker is told, and skin and grey things are none") {
  const auto colour = [](std::array<int, 3> rgb) -> std::optional<StickerColour> {
    const auto dots = find_label_dots(frame(rgb, 30, 66), line());
    return dots.empty() ? std::nullopt : std::optional(dots.back().colour);
  };
  CHECK(colour({72, 63, 11}) == StickerColour::yellow);
  CHECK(colour({14, 50, 20}) == StickerColour::green);
  CHECK(colour({11, 25, 58}) == StickerColour::blue);
  CHECK(colour({63, 13, 45}) == StickerColour::magenta);
  CHECK_FALSE(colour({60, 45, 36}));
  CHECK_FALSE(colour({32, 20, 14}));  // dark skin
  CHECK_FALSE(colour({90, 90, 90}));
  CHECK_FALSE(colour({4, 4, 9}));  // too dark to have a colour
  for (const StickerColour one : sticker_colours) CHECK(sticker_colour(name_of(one)) == one);
  CHECK_FALSE(sticker_colour("red"));
}

TEST_CASE("grey frames cannot show stickers and are refused") {
  GreyCamera camera;
  StickerWatch watch(camera, ScannerCalibration{}, 0.3, 4.0);
  const auto frame = watch.next_frame(frame_timeout_s);
  REQUIRE_FALSE(frame.has_value());
  CHECK(frame.error().message.find("grey") != std::string::npos);
}

}  // namespace tuina::scanner
