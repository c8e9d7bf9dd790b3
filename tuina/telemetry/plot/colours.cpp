// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/colours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tuina::telemetry {

Colour colour_of(Arm arm) {
  return arm == Arm::left ? Colour{214, 128, 36} : Colour{70, 92, 156};
}

Colour mix(Colour from, Colour to, double share) {
  const auto between = [share](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + (b - a) * share));
  };
  return {between(from.red, to.red), between(from.green, to.green), between(from.blue, to.blue)};
}

Colour hardness_colour(double share) {
  // Viridis (S. van der Walt and N. Smith, CC0), turned about: light is soft, dark is hard.
  static constexpr std::array<Colour, 9> stops = {{{253, 231, 37},
                                                   {170, 220, 50},
                                                   {94, 201, 98},
                                                   {39, 173, 129},
                                                   {33, 145, 140},
                                                   {44, 114, 142},
                                                   {59, 82, 139},
                                                   {71, 45, 123},
                                                   {68, 1, 84}}};
  const double at = std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * (stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mix(stops[below], stops[below + 1], at - static_cast<double>(below));
}

std::string css(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

// IEC 61966-2-1, the transfer function of sRGB.
std::array<float, 3> to_light(Colour colour) {
  const auto light = [](std::uint8_t value) {
    const float v = static_cast<float>(value) / 255.F;
    return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
  };
  return {light(colour.red), light(colour.green), light(colour.blue)};
}

Colour from_light(const std::array<float, 3>& light) {
  const auto value = [](float l) {
    l = std::clamp(l, 0.F, 1.F);
    const float v = l <= 0.0031308F ? 12.92F * l : 1.055F * std::pow(l, 1.F / 2.4F) - 0.055F;
    return static_cast<std::uint8_t>(std::lround(255.F * v));
  };
  return {value(light[0]), value(light[1]), value(light[2])};
}

}  // namespace tuina::telemetry
