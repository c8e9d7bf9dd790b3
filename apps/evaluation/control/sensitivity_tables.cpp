// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/evaluation/control/worlds.hpp"

namespace tuina::app {
namespace {

// Where the contact trembles: an arm that is calm with one spring, damping and delay may not be
// with another. Rigid torso, no error of the surface.
ControlRow trembling(const char* law, const char* what, double value, double K, int late_ms) {
  return {.labels = {{"law", law},
                     {"late_ms", fmt::format("{}", late_ms)},
                     {"stiffness_n_per_m", fmt::format("{:.0f}", K)},
                     {what, fmt::format("{:g}", value)}},
          .runs = {}};
}

}  // namespace

// The leash likes a soft spring, tracking without a force loop a stiff one.
ControlTable stiffness_table(bool full, std::uint64_t seed) {
  ControlTable table{.name = "stiffness",
                     .about =
                         "The spring along the normal: what it means for tracking 30 N, for "
                         "skin that leaves and for a person who rises.",
                     .rows = {}};
  const std::vector<double> springs =
      full ? std::vector{250.0, 500.0, 1000.0, 2000.0, 4000.0} : std::vector{250.0, 1000.0, 4000.0};
  for (const double K : springs) {
    const auto add = [&](const char* what, control::Law law,
                         const std::vector<sim::Shift>& shifts) {
      ControlRow row = on_all_tissues(what, 30.0, 1, seed, [&](auto& run) {
        run.controller.law = law;
        run.controller.force.stiffness_n_per_m = K;
        run.shifts = shifts;
      });
      row.labels.emplace_back("stiffness_n_per_m", fmt::format("{:.0f}", K));
      table.rows.push_back(std::move(row));
    };
    add("press, tuina", control::Law::tuina, {});
    add("press, without trim", control::Law::virtual_target, {});
    add("leaves, without trim", control::Law::virtual_target, {person_moves(-50.0, 0.5)});
    add("rises, without trim", control::Law::virtual_target, {person_moves(30.0, 0.1)});
  }
  return table;
}

ControlTable devices_table(std::uint64_t seed) {
  ControlTable table{.name = "devices",
                     .about = "A press of 30 N with other encoders, amplifiers and wrist sensors.",
                     .rows = {}};
  const auto add = [&](std::string what, const auto& change) {
    ControlRow row =
        on_all_tissues(std::move(what), 30.0, 1, seed, [&](auto& run) { change(run.devices); });
    table.rows.push_back(std::move(row));
  };
  using sim::PlantOptions;
  add("as they are: 200 000 counts, 16 bit, 0.05 N", [](PlantOptions&) {});
  add("exact encoders", [](PlantOptions& plant) { plant.encoder_counts = 0.0; });
  add("encoders of 20 000 counts", [](PlantOptions& plant) { plant.encoder_counts = 20e3; });
  add("encoders of 8 000 counts", [](PlantOptions& plant) { plant.encoder_counts = 8e3; });
  add("DAC of 12 bit", [](PlantOptions& plant) { plant.dac_bits = 12; });
  add("DAC of 10 bit", [](PlantOptions& plant) { plant.dac_bits = 10; });
  add("wrist noise 0.2 N", [](PlantOptions& plant) { plant.wrist_noise_n = 0.2; });
  add("wrist noise 0.5 N", [](PlantOptions& plant) { plant.wrist_noise_n = 0.5; });
  add("wrist low-pass 30 Hz", [](PlantOptions& plant) { plant.wrist_low_pass_hz = 30.0; });
  return table;
}

ControlTable stability_table(bool full, std::uint64_t seed) {
  ControlTable table{.name = "stability",
                     .about =
                         "Ripple of the true force while 30 N stand still on a rigid torso, by "
                         "spring, damping and delay of the torques.",
                     .rows = {}};
  const std::vector<double> springs =
      full ? std::vector{250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0}
           : std::vector{500.0, 1000.0, 4000.0};
  const std::vector<double> shares =
      full ? std::vector{0.1, 0.25, 0.5, 1.0, 2.0} : std::vector{0.25, 1.0, 2.0};
  const std::vector<int> delays_ms = full ? std::vector{1, 3, 5} : std::vector{1, 5};
  const std::vector<double> masses_kg =
      full ? std::vector{0.5, 1.0, 2.0, 3.0, 4.0, 8.0} : std::vector{1.0, 2.0, 4.0};
  const auto add_runs = [&](ControlRow row, const auto& change) {
    for (const TangentTissue& tissue : {bone, soft_muscle}) {
      if (!full && tissue.alpha_n != bone.alpha_n) continue;
      ContactExperiment run = wrong_world(tissue, 30.0, seed);
      run.surface_error_m = 0.0;
      run.torso_n_per_m = sim::rigid;
      change(run);
      row.runs.push_back(run);
    }
    table.rows.push_back(std::move(row));
  };
  for (const int late_ms : delays_ms) {
    for (const double K : springs)
      for (const double share : shares)
        add_runs(trembling("tuina", "damping_share", share, K, late_ms), [&](auto& run) {
          control::ForceTarget::Options& force = run.controller.force;
          force.stiffness_n_per_m = K;
          force.free_damping_ratio *= share;
          force.contact_damping_ratio *= share;
          force.max_damping_n_s_per_m *= share;
          run.late_ticks = late_ms;
        });
    for (const double K : springs)
      for (const double mass_kg : masses_kg)
        add_runs(trembling("thesis", "mass_kg", mass_kg, K, late_ms), [&](auto& run) {
          choose(run, {"", control::Law::thesis, mass_kg});
          run.controller.thesis.stiffness_n_per_m = K;
          run.late_ticks = late_ms;
        });
  }
  return table;
}

}  // namespace tuina::app
