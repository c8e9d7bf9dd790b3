// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "apps/evaluation/control/trials.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {

struct NamedTissue {
  const char* name;
  TangentTissue tissue;
};
inline constexpr std::array<NamedTissue, 3> tissues = {
    {{"bone", bone}, {"hard", hard_muscle}, {"soft", soft_muscle}}};

struct Torso {
  const char* name;
  double n_per_m;
};
inline constexpr std::array<Torso, 2> torsos = {{{"35 N/mm", 35'000.0}, {"rigid", sim::rigid}}};

/// One experiment with everything wrong that a session has wrong: masses and so gravity by 10 %,
/// all links in the same direction, friction by 20 %, alpha and beta by 30 %, the skin by 3 mm.
inline ContactExperiment wrong_world(const TangentTissue& tissue, double force_n,
                                     std::uint64_t seed) {
  ContactExperiment experiment;
  experiment.tissue = tissue;
  experiment.force_n = force_n;
  experiment.seed = seed;
  experiment.surface_error_m = seed % 2 == 0 ? 3_mm : -3_mm;
  experiment.mass_scale = seed % 4 < 2 ? 1.1 : 0.9;
  experiment.duration_s = 5.0;
  return experiment;
}

inline sim::Shift person_moves(double outward_mm, double m_per_s, double m_per_s2 = 0.0) {
  sim::Shift shift{.start_s = 2.0,
                   .by_in_couch = Vector3(0.0, 1e-3 * outward_mm, 0.0),
                   .speed_m_per_s = m_per_s};
  if (m_per_s2 > 0.0) shift.acceleration_m_per_s2 = m_per_s2;
  return shift;
}

/// A row of one experiment on every tissue with several seeds.
template <typename Change>
ControlRow on_all_tissues(std::string what, double force_n, int seeds, std::uint64_t first_seed,
                          const Change& change) {
  ControlRow row{.labels = {{"what", std::move(what)}}, .runs = {}};
  for (const NamedTissue& tissue : tissues) {
    for (int k = 0; k < seeds; ++k) {
      row.runs.push_back(wrong_world(tissue.tissue, force_n,
                                     first_seed + static_cast<std::uint64_t>(row.runs.size())));
      change(row.runs.back());
    }
  }
  return row;
}

/// What the spring along the normal, sensors and drives, damping and delay mean.
[[nodiscard]] ControlTable stiffness_table(bool full, std::uint64_t seed);
[[nodiscard]] ControlTable devices_table(std::uint64_t seed);
[[nodiscard]] ControlTable stability_table(bool full, std::uint64_t seed);
/// What rules A5 and A6 of the tissue would do to the force.
[[nodiscard]] ControlTable rules_table(std::uint64_t seed);

}  // namespace tuina::app
