// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/tangent_model.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::tissue {
namespace {

constexpr double last_angle = tangent_limit * pi / 2.0;

double force_at_limit(const TangentTissue& tissue) noexcept {
  return tissue.alpha_n * std::tan(last_angle);
}

}  // namespace

double force_at_depth(const TangentTissue& tissue, double depth_m) noexcept {
  if (!(depth_m > 0.0)) return 0.0;
  const double angle = tissue.beta_per_m * depth_m;
  if (angle <= last_angle) return tissue.alpha_n * std::tan(angle);
  return force_at_limit(tissue) +
         stiffness_at_depth(tissue, depth_m) * (depth_m - last_angle / tissue.beta_per_m);
}

double depth_at_force(const TangentTissue& tissue, double force_n) noexcept {
  if (!(force_n > 0.0)) return 0.0;
  const double limit_n = force_at_limit(tissue);
  if (force_n <= limit_n) return std::atan(force_n / tissue.alpha_n) / tissue.beta_per_m;
  return last_angle / tissue.beta_per_m + (force_n - limit_n) / stiffness_at_force(tissue, force_n);
}

double stiffness_at_force(const TangentTissue& tissue, double force_n) noexcept {
  const double q = std::clamp(force_n / tissue.alpha_n, 0.0, std::tan(last_angle));
  return tissue.alpha_n * tissue.beta_per_m * (1.0 + q * q);
}

TangentTissue tangent_through(double force_n, double depth_m, double half_force_depth_m) noexcept {
  // atan(u) / atan(u / 2) falls from 2 to 1 as u = force / alpha grows.
  double low = 0.02, high = 200.0;
  for (int i = 0; i < 40; ++i) {
    const double u = std::sqrt(low * high);
    (std::atan(u) * half_force_depth_m > std::atan(0.5 * u) * depth_m ? low : high) = u;
  }
  const double u = std::sqrt(low * high);
  return {force_n / u, std::atan(u) / std::max(depth_m, 1e-6)};
}

double stiffness_at_depth(const TangentTissue& tissue, double depth_m) noexcept {
  const double angle = std::clamp(tissue.beta_per_m * depth_m, 0.0, last_angle);
  const double q = std::tan(angle);
  return tissue.alpha_n * tissue.beta_per_m * (1.0 + q * q);
}

}  // namespace tuina::tissue
