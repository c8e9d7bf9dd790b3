// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/evaluation/control/worlds.hpp"

namespace tuina::app {
namespace {

std::vector<Choice> springs(const std::vector<double>& n_per_m) {
  return numbers(n_per_m, [](auto& run, double K) {
    auto& controller = run.controller;
    (controller.law == control::ControlLaw::thesis ? controller.thesis.stiffness_n_per_m
                                                   : controller.force.stiffness_n_per_m) = K;
  });
}

/// A law on bone, in the full form on soft muscle too: a rigid torso, no error of the surface, the
/// torques late by so many milliseconds.
ControlRow standing_still(const ControllerChoice& law, int late_ms, bool full, std::uint64_t seed) {
  ControlRow row{.labels = {{"law", law.name}, {"late_ms", fmt::format("{}", late_ms)}},
                 .runs = {}};
  for (const TangentTissue& tissue : {bone, soft_muscle}) {
    if (!full && tissue.alpha_n != bone.alpha_n) continue;
    ContactExperiment& run = row.runs.emplace_back(wrong_world(30.0, seed));
    run.tissue = tissue;
    run.surface_error_m = 0.0;
    run.torso_n_per_m = sim::rigid;
    run.late_ticks = late_ms;
    choose(run, law);
  }
  return row;
}

}  // namespace

// The leash likes a soft spring, tracking without a force loop a stiff one.
ControlTable stiffness_table(bool full, std::uint64_t seed) {
  const auto without_trim = [](const std::vector<sim::Shift>& shifts) {
    return [shifts](ContactExperiment& run) {
      run.controller.law = control::ControlLaw::virtual_target;
      run.shifts = shifts;
    };
  };
  auto rows = varied({on_all_tissues(30.0, 1, seed)}, "stiffness_n_per_m",
                     springs(full ? std::vector{250.0, 500.0, 1000.0, 2000.0, 4000.0}
                                  : std::vector{250.0, 1000.0, 4000.0}));
  rows =
      varied(rows, "what",
             {{"press, tuina", [](auto& run) { run.controller.law = control::ControlLaw::tuina; }},
              {"press, without trim", without_trim({})},
              {"leaves, without trim", without_trim({person_moves(-50.0, 0.5)})},
              {"rises, without trim", without_trim({person_moves(30.0, 0.1)})}});
  return {.name = "stiffness",
          .about =
              "The spring along the normal: what it means for tracking 30 N, for skin that leaves "
              "and for a person who rises.",
          .rows = std::move(rows)};
}

ControlTable devices_table(std::uint64_t seed) {
  return {.name = "devices",
          .about = "A press of 30 N with other encoders, amplifiers and wrist sensors.",
          .rows = varied(
              {on_all_tissues(30.0, 1, seed)}, "what",
              {{"as they are: 200 000 counts, 16 bit, 0.05 N", [](auto&) {}},
               {"exact encoders", [](auto& run) { run.devices.encoder_counts = 0.0; }},
               {"encoders of 20 000 counts", [](auto& run) { run.devices.encoder_counts = 20e3; }},
               {"encoders of 8 000 counts", [](auto& run) { run.devices.encoder_counts = 8e3; }},
               {"DAC of 12 bit", [](auto& run) { run.devices.dac_bits = 12; }},
               {"DAC of 10 bit", [](auto& run) { run.devices.dac_bits = 10; }},
               {"wrist noise 0.2 N", [](auto& run) { run.devices.wrist_noise_n = 0.2; }},
               {"wrist noise 0.5 N", [](auto& run) { run.devices.wrist_noise_n = 0.5; }},
               {"wrist low-pass 30 Hz", [](auto& run) { run.devices.wrist_low_pass_hz = 30.0; }}})};
}

// An arm that is calm with one spring, damping and delay may tremble with another.
ControlTable stability_table(bool full, std::uint64_t seed) {
  ControlTable table{.name = "stability",
                     .about =
                         "Ripple of the true force while 30 N stand still on a rigid torso, by "
                         "spring, damping and delay of the torques.",
                     .rows = {}};
  const auto stiffness = springs(full ? std::vector{250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0}
                                      : std::vector{500.0, 1000.0, 4000.0});
  const auto damping =
      numbers(full ? std::vector{0.1, 0.25, 0.5, 1.0, 2.0} : std::vector{0.25, 1.0, 2.0},
              [](auto& run, double share) {
                run.controller.force.free_damping_ratio *= share;
                run.controller.force.contact_damping_ratio *= share;
                run.controller.force.max_damping_n_s_per_m *= share;
              });
  const auto masses =
      numbers(full ? std::vector{0.5, 1.0, 2.0, 3.0, 4.0, 8.0} : std::vector{1.0, 2.0, 4.0},
              [](auto& run, double mass_kg) { run.controller.thesis.mass_kg = mass_kg; });
  const auto add = [&](const ControllerChoice& law, int late_ms, const char* label,
                       const std::vector<Choice>& choices) {
    auto rows = varied({standing_still(law, late_ms, full, seed)}, "stiffness_n_per_m", stiffness);
    rows = varied(rows, label, choices);
    table.rows.insert(table.rows.end(), rows.begin(), rows.end());
  };
  for (const int late_ms : full ? std::vector{1, 3, 5} : std::vector{1, 5}) {
    add({"tuina", control::ControlLaw::tuina, 0.0}, late_ms, "damping_share", damping);
    add({"thesis", control::ControlLaw::thesis, 1.0}, late_ms, "mass_kg", masses);
  }
  return table;
}

}  // namespace tuina::app
