// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace tuina::scanner {
namespace {

template <typename Sample>
bool spike_at(const Sample* row, int x, float min_dn, const LineScene& scene) {
  const auto here = static_cast<float>(row[x]);
  const float left = x > scene.first_column ? static_cast<float>(row[x - 1]) : 0.0F;
  const float right = x < scene.last_column ? static_cast<float>(row[x + 1]) : 0.0F;
  return here - std::max(left, right) > min_dn;
}

template <typename Sample>
bool spike_near(const Sample* row, int column, float height_dn, const LineScene& scene) {
  const float least = min_spike_over_noise * scene.noise_dn + height_dn * spike_share(scene);
  const int from = std::max(scene.first_column, column - scene.beside_px);
  const int to = std::min(scene.last_column, column + scene.beside_px);
  for (int x = from; x <= to; ++x) {
    if (spike_at(row, x, least, scene)) return true;
  }
  return false;
}

template <typename Sample>
std::optional<LinePoint> fit(const Sample* row, float column_px, const LineScene& scene) {
  const auto clipped = [&](int x) { return static_cast<float>(row[x]) >= scene.saturated_dn; };
  int left =
      std::clamp(static_cast<int>(std::lround(column_px)), scene.first_column, scene.last_column);
  int right = left;
  if (clipped(left)) {
    while (left > scene.first_column && clipped(left - 1)) --left;
    while (right < scene.last_column && clipped(right + 1)) ++right;
  }
  const int from = std::max(scene.first_column, left - scene.beside_px - 6);
  const int to = std::min(scene.last_column, right + scene.beside_px + 6);
  double x0 = left == right ? static_cast<double>(column_px) : 0.5 * (left + right);
  std::vector<int> used;
  double lowest = scene.saturated_dn;
  double highest = 0.0;
  const float least =
      min_spike_over_noise * scene.noise_dn + static_cast<float>(row[left]) * spike_share(scene);
  for (int x = from; x <= to; ++x) {
    if (clipped(x) || (left == right && spike_at(row, x, least, scene))) continue;
    used.push_back(x);
    lowest = std::min(lowest, static_cast<double>(row[x]));
    highest = std::max(highest, static_cast<double>(row[x]));
  }
  if (used.size() < 6) return {};

  // Initial height of a line with n clipped pixels.
  double width = scene.width_px;
  double amplitude = highest - lowest;
  if (clipped(left)) {
    const double half_plateau = 0.5 * (right - left + 1);
    amplitude = (scene.saturated_dn - lowest) *
                std::exp(std::min(3.0, 0.5 * half_plateau * half_plateau / (width * width)));
  }
  double background = lowest;
  const double noise2 = static_cast<double>(scene.noise_dn) * static_cast<double>(scene.noise_dn);
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  for (int step = 0; step < 20; ++step) {
    normal.setZero();
    Eigen::Vector4d rhs = Eigen::Vector4d::Zero();
    for (const int x : used) {
      const double u = (x - x0) / width;
      const double g = std::exp(-0.5 * u * u);
      const Eigen::Vector4d slope(g, amplitude * g * u / width, 1.0, amplitude * g * u * u / width);
      const double error = static_cast<double>(row[x]) - amplitude * g - background;
      rhs += slope * error;
      normal += slope * slope.transpose();
    }
    // The flanks of a clipped line hardly separate height from width; a prior of the usual width
    // within a third keeps the fit plausible.
    const double trust = noise2 / std::pow(0.33 * static_cast<double>(scene.width_px), 2);
    normal(3, 3) += trust;
    rhs(3) += trust * (static_cast<double>(scene.width_px) - width);
    const Eigen::Vector4d move = normal.ldlt().solve(rhs);
    if (!move.allFinite()) return {};
    amplitude = std::clamp(amplitude + move(0), 0.5 * amplitude, 2.0 * amplitude);
    x0 += std::clamp(move(1), -width, width);
    background += move(2);
    width = std::clamp(width + move(3), 0.7 * width, 1.4 * width);
    if (std::abs(move(1)) < 1e-4 && std::abs(move(3)) < 1e-2) break;
  }
  // Half of the line must be in the image, and the fit near its start.
  if (x0 < scene.first_column + 0.5 * width || x0 > scene.last_column - 0.5 * width) return {};
  if (std::abs(x0 - 0.5 * (left + right)) > 2.0 + 0.5 * (right - left) + scene.width_px) return {};
  const Eigen::Matrix4d covariance = noise2 * normal.ldlt().solve(Eigen::Matrix4d::Identity());
  if (!(covariance(0, 0) > 0.0 && covariance(1, 1) > 0.0)) return {};
  // A narrow fit to a few noisy pixels is high but uncertain.
  if (!clipped(left) && amplitude < 5.0 * std::sqrt(covariance(0, 0))) return {};
  return LinePoint{.row = 0,
                   .column_px = static_cast<float>(x0),
                   .amplitude_dn = static_cast<float>(amplitude),
                   .deviation_px = static_cast<float>(std::sqrt(covariance(1, 1)))};
}

}  // namespace

float spike_share(const LineScene& scene) {
  return std::min(0.8F, 0.61F / scene.width_px);
}

bool has_spike(const std::uint8_t* row, int column, float height_dn, const LineScene& scene) {
  return spike_near(row, column, height_dn, scene);
}

bool has_spike(const float* row, int column, float height_dn, const LineScene& scene) {
  return spike_near(row, column, height_dn, scene);
}

std::optional<LinePoint> fit_line(const std::uint8_t* row, float column_px,
                                  const LineScene& scene) {
  return fit(row, column_px, scene);
}

std::optional<LinePoint> fit_line(const float* row, float column_px, const LineScene& scene) {
  return fit(row, column_px, scene);
}

}  // namespace tuina::scanner
