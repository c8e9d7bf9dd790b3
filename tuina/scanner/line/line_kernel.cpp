// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_kernel.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/units.hpp"
#include "tuina/scanner/line/twice.hpp"

namespace tuina::scanner {
namespace {

constexpr double min_width_px = 0.5;
constexpr double width_step_px = 0.25;
constexpr int widths = static_cast<int>((max_kernel_px - min_width_px) / width_step_px) + 1;

double centre_of(int phase) {
  return static_cast<double>(LineKernel::centre_of(phase));
}

using Taps = std::array<float, LineKernel::taps>;
using WholeTaps = std::array<std::int16_t, LineKernel::taps>;

// Rounds with error diffusion: the weights still sum to zero, else the background would bias them.
WholeTaps rounded(const Taps& weights, double unit) {
  WholeTaps whole;
  double carried = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    carried += static_cast<double>(weights[i]) / unit;
    const double nearest = std::round(carried);
    whole[i] = static_cast<std::int16_t>(nearest);
    carried -= nearest;
  }
  return whole;
}

void add_whole_weights(LineKernel& kernel) {
  constexpr double most = 32000.0;  // of 32767; the rest is for the carried error
  double offset_unit = 0.0;
  double height_unit = 0.0;
  for (const auto& weights : kernel.of_phase) {
    for (const float w : weights.offset) offset_unit = std::max(offset_unit, std::abs(double{w}));
    for (const float w : weights.height) height_unit = std::max(height_unit, std::abs(double{w}));
  }
  offset_unit /= most;
  height_unit /= most;
  for (std::size_t phase = 0; phase < LineKernel::phases; ++phase) {
    const auto& weights = kernel.of_phase[phase];
    kernel.whole_of_phase[phase] = {.offset = rounded(weights.offset, offset_unit),
                                    .height = rounded(weights.height, height_unit)};
  }
  kernel.whole_offset = static_cast<float>(offset_unit / height_unit);
  kernel.whole_height = static_cast<float>(height_unit);
}

// Least squares of amplitude A, shift and background b in A g(u) + (A shift) g(u) u / width^2 + b:
// one Gauss-Newton step to the maximum-likelihood position for equal Gaussian pixel noise.
LineKernel make_gaussian(double width_px) {
  LineKernel kernel{};
  for (int phase = 0; phase < LineKernel::phases; ++phase) {
    Eigen::Matrix<double, LineKernel::taps, 3> model;
    for (int i = 0; i < LineKernel::taps; ++i) {
      const double u = i - LineKernel::before - centre_of(phase);
      const double g = std::exp(-0.5 * u * u / (width_px * width_px));
      model.row(i) << g, g * u / (width_px * width_px), 1.0;
    }
    const Eigen::Matrix3d covariance = (model.transpose() * model).inverse();
    const Eigen::Matrix<double, 3, LineKernel::taps> solve = covariance * model.transpose();
    auto& weights = kernel.of_phase[static_cast<std::size_t>(phase)];
    for (int i = 0; i < LineKernel::taps; ++i) {
      weights.height[static_cast<std::size_t>(i)] = static_cast<float>(solve(0, i));
      weights.offset[static_cast<std::size_t>(i)] = static_cast<float>(solve(1, i));
    }
    kernel.deviation_factor = static_cast<float>(std::sqrt(covariance(1, 1)));
    kernel.height_factor = static_cast<float>(std::sqrt(covariance(0, 0)));
  }
  return kernel;
}

// [thesis] (4.10) within a window centred to a fraction of a pixel, above the mean of the pixels
// beside it. 2.4 widths lose little light and admit little noise.
LineKernel make_centroid(double width_px) {
  const double half = std::max(1.5, 2.4 * width_px);
  LineKernel kernel{};
  for (int phase = 0; phase < LineKernel::phases; ++phase) {
    Eigen::Array<double, LineKernel::taps, 1> u;
    Eigen::Array<double, LineKernel::taps, 1> inside;
    Eigen::Array<double, LineKernel::taps, 1> beside;
    for (int i = 0; i < LineKernel::taps; ++i) {
      u(i) = i - LineKernel::before - centre_of(phase);
      inside(i) = std::clamp(half + 0.5 - std::abs(u(i)), 0.0, 1.0);
      beside(i) = std::abs(u(i)) > std::max(3.2 * width_px, half + 0.5) ? 1.0 : 0.0;
    }
    beside /= beside.sum();
    // The share `kept` of the line's light is inside the window; amplitude follows from it.
    const double kept = std::erf(half / width_px / std::sqrt(2.0)) * width_px * std::sqrt(2.0 * pi);
    const Eigen::Array<double, LineKernel::taps, 1> height =
        (inside - inside.sum() * beside) / kept;
    // The window is fixed while the line moves in it, so the centroid moves slightly less than the
    // line.
    const double k = half / width_px;
    const double follows =
        1.0 - 2.0 * k * std::exp(-0.5 * k * k) / std::sqrt(2.0 * pi) / std::erf(k / std::sqrt(2.0));
    const Eigen::Array<double, LineKernel::taps, 1> offset =
        (inside * u - (inside * u).sum() * beside) / kept / follows;
    auto& weights = kernel.of_phase[static_cast<std::size_t>(phase)];
    for (int i = 0; i < LineKernel::taps; ++i) {
      weights.height[static_cast<std::size_t>(i)] = static_cast<float>(height(i));
      weights.offset[static_cast<std::size_t>(i)] = static_cast<float>(offset(i));
    }
    kernel.deviation_factor = static_cast<float>(std::sqrt(offset.square().sum()));
    kernel.height_factor = static_cast<float>(std::sqrt(height.square().sum()));
  }
  return kernel;
}

std::vector<LineKernel> make_all(LineKernel (*make)(double)) {
  std::vector<LineKernel> kernels;
  for (int i = 0; i < widths; ++i) {
    kernels.push_back(make(min_width_px + i * width_step_px));
    add_whole_weights(kernels.back());
  }
  return kernels;
}

std::size_t index_of(double width_px) {
  const double step = (width_px - min_width_px) / width_step_px;
  return static_cast<std::size_t>(std::clamp(static_cast<int>(std::lround(step)), 0, widths - 1));
}

// Eight parallel sums, one vector register, so that the order of additions does not depend on the
// compiler.
[[gnu::always_inline]] inline LineStep weigh_all(const float* samples,
                                                 const LineKernel::Weights& weights) noexcept {
  constexpr std::size_t lanes = 8;
  std::array<float, lanes> offset = {};
  std::array<float, lanes> height = {};
  for (std::size_t i = 0; i < LineKernel::taps; i += lanes) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      offset[lane] += samples[i + lane] * weights.offset[i + lane];
      height[lane] += samples[i + lane] * weights.height[i + lane];
    }
  }
  const auto sum = [](const std::array<float, lanes>& a) {
    return ((a[0] + a[4]) + (a[1] + a[5])) + ((a[2] + a[6]) + (a[3] + a[7]));
  };
  return {sum(offset), sum(height)};
}

}  // namespace

const LineKernel& gaussian_kernel(double width_px) {
  static const std::vector<LineKernel> kernels = make_all(make_gaussian);
  return kernels[index_of(width_px)];
}

const LineKernel& centroid_kernel(double width_px) {
  static const std::vector<LineKernel> kernels = make_all(make_centroid);
  return kernels[index_of(width_px)];
}

TUINA_TWICE LineStep weigh(const float* samples, const LineKernel::Weights& weights) noexcept {
  return weigh_all(samples, weights);
}

TUINA_TWICE std::uint8_t largest(const std::uint8_t* samples, int count) noexcept {
  std::uint8_t most = 0;
  for (int i = 0; i < count; ++i) most = std::max(most, samples[i]);
  return most;
}

TUINA_TWICE float largest(const float* samples, int count) noexcept {
  // Eight at a time: one maximum that waits for the one before it takes four times as long.
  constexpr int lanes = 8;
  std::array<float, lanes> most;
  most.fill(samples[0]);
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const float sample = samples[static_cast<std::size_t>(i) + lane];
      most[lane] = sample > most[lane] ? sample : most[lane];
    }
  }
  for (; i < count; ++i) most[0] = samples[i] > most[0] ? samples[i] : most[0];
  return *std::max_element(most.begin(), most.end());
}

}  // namespace tuina::scanner
