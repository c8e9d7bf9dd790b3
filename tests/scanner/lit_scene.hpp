// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
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

}  // namespace tuina::test
