// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "tuina/core/arm.hpp"
#include "tuina/core/colour.hpp"
#include "tuina/core/technique.hpp"

namespace tuina::telemetry {

using tuina::Colour;

/// Colour of a technique, as everywhere.
[[nodiscard]] constexpr Colour colour_of(Technique technique) {
  return row_of(technique).colour;
}

/// One palette for every picture, plot and page, so that a colour means the same everywhere. The
/// techniques and arms stay apart for red-green blind eyes and in grey print.
namespace palette {
inline constexpr Colour ink = {31, 35, 42};
inline constexpr Colour grey = {112, 118, 128};
inline constexpr Colour hairline = {222, 225, 230};
inline constexpr Colour paper = {255, 255, 255};
inline constexpr Colour skin = {219, 170, 143};
inline constexpr Colour clay = {205, 203, 198};
inline constexpr Colour press = colour_of(Technique::press);
inline constexpr Colour rub = colour_of(Technique::rub);
inline constexpr Colour stroke = colour_of(Technique::stroke);
inline constexpr Colour tap = colour_of(Technique::tap);
inline constexpr Colour stop = {214, 30, 62};
inline constexpr Colour marker = {250, 246, 236};
}  // namespace palette

/// Colour of an arm, as everywhere.
[[nodiscard]] Colour colour_of(Arm arm);

/// From soft (0) to hard (1): yellow over green and blue to violet, evenly darker all the way.
[[nodiscard]] Colour hardness_colour(double share);

/// From one colour (0) to another (1).
[[nodiscard]] Colour mix(Colour from, Colour to, double share);

/// `#rrggbb`
[[nodiscard]] std::string css(Colour colour);

/// The amounts of light, 0 to 1, in which shading computes.
[[nodiscard]] std::array<float, 3> to_light(Colour colour);
/// The colour of such amounts; what is below 0 or above 1 counts as that.
[[nodiscard]] Colour from_light(const std::array<float, 3>& light);

}  // namespace tuina::telemetry
