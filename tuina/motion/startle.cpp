// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/startle.hpp"

#include <algorithm>

#include "tuina/control/tool_motion.hpp"
#include "tuina/core/units.hpp"

namespace tuina::motion {
namespace {

// Fault 16, "starts up".
constexpr double start_m_per_s2 = 2.0 * gravity_m_per_s2, start_m_per_s = 0.4, start_m = 60_mm;
constexpr double reaction_s = 3e-3;
constexpr double pull_out_n = 80.0;  // what the guard's retract may use
constexpr double let_go_n_per_s = 10'000.0;
constexpr double friction_n = 8.0;
constexpr double torso_n_per_m = 35e3;

/// Table 6-2 of [thesis], slim men: the hardest of what may lie there.
TangentTissue hardest_in(massage::Zone zone) noexcept {
  constexpr TangentTissue bone = {.alpha_n = 5.1, .beta_per_m = 270.0};
  constexpr TangentTissue hard = {.alpha_n = 11.5, .beta_per_m = 250.0};
  return zone == massage::Zone::muscle || zone == massage::Zone::kidney ? hard : bone;
}

}  // namespace

double startle_force_n(double apparent_mass_kg, double force_n,
                       const TangentTissue& tissue) noexcept {
  constexpr double step_s = 1e-4;
  constexpr int steps = 2000;
  double contact_n = force_n, max_n = force_n;
  double drive_n = -force_n;  // of the drives, outward
  double skin_m_per_s = 0.0, skin_m = 0.0, tool_m_per_s = 0.0;
  for (int step = 0; step < steps; ++step) {
    const double time_s = step * step_s;
    skin_m_per_s =
        skin_m < start_m ? std::min(start_m_per_s, skin_m_per_s + start_m_per_s2 * step_s) : 0.0;
    skin_m += skin_m_per_s * step_s;
    // The derivative of the depth of tangent law and torso in series.
    const double alpha_n = tissue.alpha_n;
    const double m_per_n =
        alpha_n / (tissue.beta_per_m * (alpha_n * alpha_n + contact_n * contact_n)) +
        1.0 / torso_n_per_m;
    contact_n = std::max(0.0, contact_n + (skin_m_per_s - tool_m_per_s) * step_s / m_per_n);
    max_n = std::max(max_n, contact_n);
    const double wanted_n = time_s < reaction_s ? -force_n : pull_out_n;
    drive_n += std::clamp(wanted_n - drive_n, -let_go_n_per_s * step_s, let_go_n_per_s * step_s);
    const double held_n = tool_m_per_s > 0.0 ? friction_n : 0.0;
    tool_m_per_s += (contact_n + drive_n - held_n) / apparent_mass_kg * step_s;
  }
  return max_n;
}

double max_pressing_n(double apparent_mass_kg, massage::Zone zone, double wanted_n) noexcept {
  const TangentTissue tissue = hardest_in(zone);
  const auto bears = [&](double force_n) {
    return startle_force_n(apparent_mass_kg, force_n, tissue) <= max_startle_n;
  };
  if (bears(wanted_n)) return wanted_n;
  double low_n = 0.0, high_n = wanted_n;
  while (high_n - low_n > 0.1) {
    const double middle_n = 0.5 * (low_n + high_n);
    (bears(middle_n) ? low_n : high_n) = middle_n;
  }
  return low_n;
}

double max_apparent_mass_kg(const robot::ArmModel& model, double rail_m,
                            const JointPath& joint_path) noexcept {
  double max_kg = 0.0;
  for (std::size_t i = 0; i < joint_path.q_rad.size(); ++i) {
    const JointVector& q_rad = joint_path.q_rad[i];
    const auto dynamics = model.evaluate(q_rad, JointVector::Zero(q_rad.size()), rail_m);
    const Vector3 axis = control::tool_normal(joint_path.poses[i].base_from_tool);
    max_kg = std::max(max_kg, robot::apparent_mass_kg(dynamics, axis));
  }
  return max_kg;
}

double mass_cost_m(double apparent_mass_kg) noexcept {
  constexpr double m_per_kg = 30e-3;
  return m_per_kg * std::max(0.0, apparent_mass_kg - light_kg);
}

}  // namespace tuina::motion
