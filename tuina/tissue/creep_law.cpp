// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/creep_law.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::tissue {
namespace {

constexpr double loading_m_per_s = 10_mm;
constexpr int loading_steps = 8;  // even: half of the force is one of them
// A tool that leaves fast must not turn the sign of the force.
constexpr double min_damping_factor = 0.3;

double damping_factor(const CreepLaw& law, double speed_m_per_s) noexcept {
  return std::max(min_damping_factor, 1.0 + law.damping_s_per_m * speed_m_per_s);
}

}  // namespace

CreepDepth depth_of(const CreepLaw& law, const Loading& loading) noexcept {
  const auto [alpha, beta] = law.tissue;
  const double m = damping_factor(law, loading.speed_m_per_s);
  double elastic_n = loading.force_n / m;
  for (std::size_t i = 0; i < memory_s.size(); ++i) elastic_n += law.creep[i] * loading.memory_n[i];
  const double u = elastic_n / alpha, softer_u = law.layer_softness * u;
  const double layer_m = law.layer_share * std::atan(softer_u) / beta;
  const double tissue_m = std::atan(u) / beta + layer_m;
  const double by_log_softness = law.layer_share * softer_u / ((1.0 + softer_u * softer_u) * beta);
  const double m_per_elastic_n =
      1.0 / (alpha * beta * (1.0 + u * u)) +
      law.layer_share * law.layer_softness / ((1.0 + softer_u * softer_u) * alpha * beta);
  CreepDepth out;
  out.depth_m = law.compliance_m_per_n * loading.force_n + tissue_m;
  out.by_log_alpha = -elastic_n * m_per_elastic_n;
  out.by_log_beta = -tissue_m;
  out.by_log_share = layer_m;
  out.by_log_softness = by_log_softness;
  out.by_log_compliance = law.compliance_m_per_n * loading.force_n;
  out.by_damping = -m_per_elastic_n * loading.force_n * loading.speed_m_per_s / (m * m);
  for (std::size_t i = 0; i < memory_s.size(); ++i)
    out.by_log_creep[i] = m_per_elastic_n * law.creep[i] * loading.memory_n[i];
  out.m_per_n = law.compliance_m_per_n + m_per_elastic_n / m;
  return out;
}

double force_of(const CreepLaw& law, double depth_m, const Memory& memory_n, double speed_m_per_s,
                double max_force_n) noexcept {
  double force_n = 0.0;
  constexpr int max_steps = 40;
  for (int i = 0; i < max_steps; ++i) {
    const CreepDepth at = depth_of(law, {force_n, memory_n, speed_m_per_s});
    const double step_n = (depth_m - at.depth_m) / at.m_per_n;
    force_n += step_n;
    if (!(force_n > 0.0)) return 0.0;
    if (force_n > max_force_n) return max_force_n;
    if (std::abs(step_n) < 1e-6 * force_n) break;
  }
  return force_n;
}

TangentTissue first_loading(const CreepLaw& law, double force_n) noexcept {
  Loading now{.speed_m_per_s = loading_m_per_s};
  double depth_m = 0.0, half_m = 0.0;
  for (int k = 1; k <= loading_steps; ++k) {
    Loading next = now;
    next.force_n = force_n * k / loading_steps;
    // How long the step takes depends on what is remembered of it, hence twice.
    for (int turn = 0; turn < 2; ++turn) {
      const double dt_s = std::max(0.0, depth_of(law, next).depth_m - depth_m) / loading_m_per_s;
      const double mean_n = 0.5 * (now.force_n + next.force_n);
      for (std::size_t i = 0; i < memory_s.size(); ++i)
        next.memory_n[i] = mean_n + std::exp(-dt_s / memory_s[i]) * (now.memory_n[i] - mean_n);
    }
    now = next;
    depth_m = depth_of(law, now).depth_m;
    if (2 * k == loading_steps) half_m = depth_m;
  }
  return tangent_through(force_n, depth_m, half_m);
}

}  // namespace tuina::tissue
