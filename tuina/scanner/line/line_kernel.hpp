// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace tuina::scanner {

/// The arithmetic of find_laser_line on 32 pixels around the line. Both methods are the same two
/// weighted sums, with different weights: `offset` divided by `height` moves the assumed centre to
/// where the line is.
struct LineKernel {
  static constexpr int taps = 32;
  static constexpr int before = 15;  ///< taps to the left of the pixel that holds the centre
  static constexpr int phases =
      16;  ///< centres per pixel; a step corrects the rest of 1/32 px linearly

  struct Weights {
    alignas(64) std::array<float, taps> offset;
    alignas(64) std::array<float, taps> height;
  };
  /// The same weights as whole numbers, for whole pixels: offset over height, times
  /// `whole_offset`, is the step; height times `whole_height` the height.
  struct WholeWeights {
    alignas(64) std::array<std::int16_t, taps> offset;
    alignas(64) std::array<std::int16_t, taps> height;
  };
  /// Where in its pixel the centre of a phase is.
  [[nodiscard]] static constexpr float centre_of(int phase) {
    return (static_cast<float>(phase) + 0.5F) / phases - 0.5F;
  }

  std::array<Weights, phases> of_phase;
  std::array<WholeWeights, phases> whole_of_phase;
  float whole_offset;
  float whole_height;
  float deviation_factor;  ///< deviation of the centre is this times noise over amplitude
  float height_factor;     ///< deviation of the amplitude is this times the noise
};

inline constexpr double max_kernel_px = 4.0;

/// The kernels for a line of this width (standard deviation, at most `max_kernel_px`).
[[nodiscard]] const LineKernel& gaussian_kernel(double width_px);
[[nodiscard]] const LineKernel& centroid_kernel(double width_px);

struct LineStep {
  float offset;
  float height;
};

/// The two weighted sums over 32 samples.
[[nodiscard]] LineStep weigh(const float* samples, const LineKernel::Weights& weights) noexcept;

/// The largest of `count` samples.
[[nodiscard]] std::uint8_t largest(const std::uint8_t* samples, int count) noexcept;
[[nodiscard]] float largest(const float* samples, int count) noexcept;

}  // namespace tuina::scanner
