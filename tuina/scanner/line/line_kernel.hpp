// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace tuina::scanner {

/// Weights of find_laser_line for 32 pixels around the line. Both methods reduce to two weighted
/// sums; `offset` / `height` is the step from the assumed centre to the line.
struct LineKernel {
  static constexpr int taps = 32;
  static constexpr int before = 15;  ///< taps to the left of the pixel with the centre
  /// Sub-pixel centres; a step corrects the remaining 1/32 px linearly.
  static constexpr int phases = 16;

  /// Weights of both sums for one sub-pixel centre.
  struct Weights {
    alignas(64) std::array<float, taps> offset;
    alignas(64) std::array<float, taps> height;
  };
  /// Integer weights: offset / height times `whole_offset` is the step, height times `whole_height`
  /// the height.
  struct WholeWeights {
    alignas(64) std::array<std::int16_t, taps> offset;
    alignas(64) std::array<std::int16_t, taps> height;
  };
  /// Sub-pixel centre of a phase.
  [[nodiscard]] static constexpr float centre_of(int phase) {
    return (static_cast<float>(phase) + 0.5F) / phases - 0.5F;
  }

  std::array<Weights, phases> of_phase;
  std::array<WholeWeights, phases> whole_of_phase;
  float whole_offset;
  float whole_height;
  float deviation_factor;  ///< standard deviation of the centre is this times noise over amplitude
  float height_factor;     ///< standard deviation of the amplitude is this times noise
};

inline constexpr double max_kernel_px = 4.0;

/// Kernels for a line width (standard deviation, at most `max_kernel_px`).
[[nodiscard]] const LineKernel& gaussian_kernel(double width_px);
[[nodiscard]] const LineKernel& centroid_kernel(double width_px);

/// Both weighted sums: their ratio is the step, px.
struct LineStep {
  float offset;
  float height;
};

/// Both weighted sums over 32 samples.
[[nodiscard]] LineStep weigh(const float* samples, const LineKernel::Weights& weights) noexcept;

/// Maximum of `count` samples.
[[nodiscard]] std::uint8_t largest(const std::uint8_t* samples, int count) noexcept;
[[nodiscard]] float largest(const float* samples, int count) noexcept;

}  // namespace tuina::scanner
