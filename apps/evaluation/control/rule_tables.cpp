// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/evaluation/control/worlds.hpp"
#include "tuina/tissue/depth_rules.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {

// What two rules of docs/tissue.md would do to the force, at their best: told the true tangent
// stiffness from the first touch on, never a late or a wrong one.
ControlTable rules_table(std::uint64_t seed) {
  ControlTable table{.name = "rules",
                     .about =
                         "A breathing person (3 mm) pressed and rubbed: the spring of the session, "
                         "springs by tangent stiffness (A5), and the share of impedance against "
                         "force control by tangent stiffness (A6).",
                     .rows = {}};
  const auto stiffness_of = [](const ContactExperiment& run) {
    return tissue::stiffness_at_force(run.tissue, run.force_n);
  };
  const auto as_it_is = [](ContactExperiment&) {};
  const auto springs = [&](ContactExperiment& run) {
    constexpr double tool_kg = 4.0;
    run.controller.force.stiffness_n_per_m =
        tissue::impedance_for(stiffness_of(run), tool_kg).stiffness_n_per_m;
  };
  const auto shares = [&](ContactExperiment& run) {
    tissue::ControlShare share;
    const double impedance = share.step(stiffness_of(run), 0.0, 1.0);
    run.controller.force.trim_per_s *= 1.0 - impedance;
    run.controller.force.gain_share *= 1.0 - impedance;
  };
  const auto only_impedance = [](ContactExperiment& run) {
    run.controller.law = control::Law::virtual_target;
  };
  const auto add = [&](const char* rule, const NamedTissue& tissue, Technique technique,
                       const auto& change) {
    constexpr std::uint64_t seeds = 4;
    constexpr double force_n = 20.0;
    ControlRow row{
        .labels = {{"rule", rule}, {"tissue", tissue.name}, {"technique", name_of(technique)}},
        .runs = {}};
    for (std::uint64_t k = 0; k < seeds; ++k) {
      row.runs.push_back(wrong_world(tissue.tissue, force_n, seed + k));
      row.runs.back().technique = technique;
      row.runs.back().breathing = {3_mm, 0.25};
      change(row.runs.back());
    }
    table.rows.push_back(std::move(row));
  };
  for (const NamedTissue& tissue : tissues) {
    for (const Technique technique : {Technique::press, Technique::rub}) {
      add("as it is: 1 N/mm and force control", tissue, technique, as_it_is);
      add("A5: half the tangent stiffness", tissue, technique, springs);
      add("A6: share by tangent stiffness", tissue, technique, shares);
      add("impedance only", tissue, technique, only_impedance);
    }
  }
  return table;
}

}  // namespace tuina::app
