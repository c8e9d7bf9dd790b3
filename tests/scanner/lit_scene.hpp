// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/core/random.hpp"

namespace tuina::test {

/// A scene in room light: a smooth random texture of two grains, this many pixels and three times
/// as large, of this contrast about a level of 100 DN.
inline Image lit_scene(int width, int height, int grain_px, double contrast_dn,
                       std::uint64_t seed = 1) {
  Random random = make_random(seed, "lit scene");
  std::vector<double> light(static_cast<std::size_t>(width * height), 100.0);
  for (const int step : {grain_px, 3 * grain_px}) {
    const int columns = width / step + 2;
    std::vector<double> knots(static_cast<std::size_t>(columns * (height / step + 2)));
    for (double& knot : knots) knot = uniform(random, -contrast_dn, contrast_dn);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto at = static_cast<std::size_t>(y / step * columns + x / step);
        const auto below = at + static_cast<std::size_t>(columns);
        const double u = static_cast<double>(x % step) / step;
        const double v = static_cast<double>(y % step) / step;
        light[static_cast<std::size_t>(y * width + x)] +=
            (1 - v) * ((1 - u) * knots[at] + u * knots[at + 1]) +
            v * ((1 - u) * knots[below] + u * knots[below + 1]);
      }
    }
  }
  Image image(width, height);
  for (std::size_t i = 0; i < light.size(); ++i)
    image.data[i] = static_cast<std::uint8_t>(std::clamp(std::round(light[i]), 0.0, 255.0));
  return image;
}

/// What a camera sees of a scene: a Gaussian line, if its amplitude is not zero, and 2 DN of noise.
template <typename Column>
Image seen(const Image& scene, double amplitude_dn, const Column& column_px, std::uint64_t seed) {
  Random random = make_random(seed, "camera");
  Image image = scene;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double u = (x - column_px(y)) / 2.5;
      const double light =
          image.row(y)[x] + amplitude_dn * std::exp(-0.5 * u * u) + gaussian(random, 2.0);
      image.row(y)[x] = static_cast<std::uint8_t>(std::clamp(std::round(light), 0.0, 255.0));
    }
  }
  return image;
}

/// What a colour camera sees of a textured scene and of two lines in it.
struct Colours {
  double laser_dn = 90.0;  ///< amplitude of the laser's line
  double white_dn = 0.0;   ///< amplitude of a white line, such as a reflection of a window
  double contrast_dn = 25.0;
  double green = 0.85;  ///< of the lamp, for its red
  double chroma = 0.0;  ///< spread of the scene's own colours
};
/// Three channels, red first; of a red light a twelfth reaches green and blue, too.
template <typename Column>
Image coloured(int width, int height, const Colours& colours, const Column& laser_px,
               const Column& white_px) {
  constexpr double leak = 0.08;
  const Image tints = lit_scene(width, height, 30, 50.0, 3);
  const Image scene = lit_scene(width, height, 12, colours.contrast_dn);
  Random random = make_random(7, "colour camera");
  Image image(width, height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto bell = [&](double column_px) {
        return std::exp(-0.5 * std::pow((x - column_px) / 2.5, 2));
      };
      const double laser = colours.laser_dn * bell(laser_px(y));
      const double white = colours.white_dn * bell(white_px(y));
      const double tint = colours.green * (1.0 + colours.chroma * (tints.row(y)[x] / 50.0 - 2.0));
      const double others = tint * scene.row(y)[x] + white + leak * laser;
      const std::array<double, 3> light = {scene.row(y)[x] + white + laser, others, others};
      for (std::size_t c = 0; c < 3; ++c) {
        const double seen = std::round(light[c] + gaussian(random, 2.0));
        image.row(y)[3 * x + static_cast<int>(c)] =
            static_cast<std::uint8_t>(std::clamp(seen, 0.0, 255.0));
      }
    }
  }
  return image;
}

}  // namespace tuina::test
