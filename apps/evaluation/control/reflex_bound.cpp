// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/reflex_bound.hpp"

#include <algorithm>

#include "apps/evaluation/control/worlds.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

constexpr double mass_kg = 3.4;  // apparent, of the tool along the normal
constexpr double person_m_per_s = 0.1;
constexpr double step_s = 1e-6;
constexpr int steps = 50'000;

double highest_n(const TangentTissue& tissue, const ReflexBound& bound) {
  const double begun_m = tissue::depth_at_force(tissue, bound.force_n);
  double tool_m = 0.0, tool_m_per_s = 0.0, highest_n = bound.force_n;
  for (int step = 0; step < steps; ++step) {
    const double time_s = step * step_s;
    const double depth_m = begun_m + person_m_per_s * time_s - tool_m;
    const double contact_n = tissue::force_at_depth(tissue, depth_m);
    const double drive_n = time_s < 1e-3 * bound.after_ms ? -bound.force_n : bound.push_n;
    tool_m_per_s += (contact_n + drive_n) / mass_kg * step_s;
    tool_m += tool_m_per_s * step_s;
    highest_n = std::max(highest_n, contact_n);
  }
  return highest_n;
}

}  // namespace

std::vector<ReflexBound> reflex_bounds() {
  constexpr double sensor_ms = 2.6;  // a sample and the low-pass of the wrist sensor
  constexpr double reflex_n = control::Escape::Options{}.push_out_n;
  constexpr double all_n = 230.0;  // the drives hold about as much on a back
  std::vector<ReflexBound> bounds;
  for (const NamedTissue& tissue : tissues) {
    for (const double force_n : {15.0, 30.0, 45.0}) {
      for (const auto& [after_ms, push_n] :
           {std::pair{0.0, reflex_n}, {1.0, reflex_n}, {sensor_ms, reflex_n}, {sensor_ms, all_n}}) {
        ReflexBound bound{
            .tissue = tissue.name, .force_n = force_n, .after_ms = after_ms, .push_n = push_n};
        bound.highest_n = highest_n(tissue.tissue, bound);
        bounds.push_back(bound);
      }
    }
  }
  return bounds;
}

}  // namespace tuina::app
