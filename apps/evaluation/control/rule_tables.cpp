// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/worlds.hpp"
#include "tuina/tissue/depth_rules.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

double stiffness_of(const ContactExperiment& run) {
  return tissue::stiffness_at_force(run.tissue, run.force_n);
}

void half_the_tangent_stiffness(ContactExperiment& run) {
  constexpr double tool_kg = 4.0;
  run.controller.force.stiffness_n_per_m =
      tissue::impedance_for(stiffness_of(run), tool_kg).stiffness_n_per_m;
}

void share_by_tangent_stiffness(ContactExperiment& run) {
  tissue::ControlShare share;
  const double impedance = share.step(stiffness_of(run), 0.0, 1.0);
  run.controller.force.trim_per_s *= 1.0 - impedance;
  run.controller.force.gain_share *= 1.0 - impedance;
}

}  // namespace

// What two rules of docs/tissue.md would do to the force, at their best: told the true tangent
// stiffness from the first touch on, never a late or a wrong one.
ControlTable rules_table(std::uint64_t seed) {
  constexpr std::uint64_t seeds = 4;
  constexpr double force_n = 20.0;
  ControlRow row{.labels = {{"rule", ""}}, .runs = {}};
  for (std::uint64_t k = 0; k < seeds; ++k) {
    row.runs.push_back(wrong_world(force_n, seed + k));
    row.runs.back().breathing = {3_mm, 0.25};
  }
  auto rows = varied({row}, "tissue", all_tissues());
  rows = varied(rows, "technique",
                {{name_of(Technique::press), [](auto& run) { run.technique = Technique::press; }},
                 {name_of(Technique::rub), [](auto& run) { run.technique = Technique::rub; }}});
  rows = varied(rows, "rule",
                {{"as it is: 1 N/mm and force control", [](auto&) {}},
                 {"A5: half the tangent stiffness", half_the_tangent_stiffness},
                 {"A6: share by tangent stiffness", share_by_tangent_stiffness},
                 {"impedance only",
                  [](auto& run) { run.controller.law = control::ControlLaw::virtual_target; }}});
  return {.name = "rules",
          .about =
              "A breathing person (3 mm) pressed and rubbed: the spring of the session, springs by "
              "tangent stiffness (A5), and the share of impedance against force control by tangent "
              "stiffness (A6).",
          .rows = std::move(rows)};
}

}  // namespace tuina::app
