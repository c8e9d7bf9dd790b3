// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"

namespace tuina::telemetry {

/// A colour as screens and paper show it (sRGB).
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

/// One palette for every picture, plot and page, so that a colour means the same everywhere. The
/// techniques and arms stay apart for red-green blind eyes and in grey print.
namespace palette {
inline constexpr Colour ink = {31, 35, 42};
inline constexpr Colour grey = {112, 118, 128};
inline constexpr Colour hairline = {222, 225, 230};
inline constexpr Colour paper = {255, 255, 255};
inline constexpr Colour skin = {219, 170, 143};
inline constexpr Colour clay = {205, 203, 198};
inline constexpr Colour press = {200, 52, 44};
inline constexpr Colour rub = {24, 104, 178};
inline constexpr Colour stroke = {16, 132, 106};
inline constexpr Colour tap = {122, 72, 160};
inline constexpr Colour stop = {214, 30, 62};
inline constexpr Colour marker = {250, 246, 236};
}  // namespace palette

[[nodiscard]] Colour colour_of(Technique technique);
[[nodiscard]] Colour colour_of(Arm arm);

/// From soft (0) to hard (1): yellow over green and blue to violet, evenly darker all the way.
[[nodiscard]] Colour hardness_colour(double share);

[[nodiscard]] Colour mix(Colour from, Colour to, double share);

/// `#rrggbb`
[[nodiscard]] std::string css(Colour colour);

/// The amounts of light, 0 to 1, in which shading computes.
[[nodiscard]] std::array<float, 3> to_light(Colour colour);
[[nodiscard]] Colour from_light(const std::array<float, 3>& light);

}  // namespace tuina::telemetry
