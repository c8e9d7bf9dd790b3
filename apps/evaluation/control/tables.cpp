// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "apps/evaluation/control/worlds.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

void as_press(ContactExperiment&) {}
void as_rub(ContactExperiment& experiment) {
  experiment.technique = Technique::rub;
  experiment.duration_s = 8.0;
  experiment.surface_tilt_rad = 2_deg;
}
void as_stroke(ContactExperiment& experiment) {
  experiment.technique = Technique::stroke;
  experiment.surface_tilt_rad = 2_deg;
}

ControlTable targets(int seeds, std::uint64_t seed) {
  ControlTable table{.name = "targets",
                     .about =
                         "What contact must hold with everything wrong at once, on bone, hard "
                         "and soft muscle; the worst run of each row.",
                     .rows = {}};
  const auto add = [&](const char* what, double force_n, const ControlTarget& target,
                       const auto& change) {
    table.rows.push_back(on_all_tissues(what, force_n, seeds, seed, change));
    table.rows.back().target = target;
  };
  const auto within = [](double rmse_n, double overshoot_n) {
    return ControlTarget{.rmse_n = rmse_n, .overshoot_n = overshoot_n, .highest_n = 90.0};
  };
  add("press 10 N", 10.0, within(0.8, 3.0), as_press);
  add("press 20 N", 20.0, within(0.8, 3.0), as_press);
  add("press 30 N", 30.0, within(0.8, 3.0), as_press);
  add("press 40 N", 40.0, within(1.5, 5.0), as_press);
  add("press 60 N", 60.0, within(1.5, 5.0), as_press);
  add("rub 30 N, breathing 3 mm", 30.0, {.rmse_n = 1.0, .highest_n = 90.0}, [](auto& experiment) {
    as_rub(experiment);
    experiment.breathing = {3_mm, 0.25};
  });
  add("stroke 15 N", 15.0, {.rmse_n = 1.0, .highest_n = 90.0}, as_stroke);
  const auto add_rigid = [&](const char* what, const auto& technique) {
    add(what, 30.0, within(2.0, 6.0), [&](auto& experiment) {
      technique(experiment);
      experiment.torso_n_per_m = sim::rigid;
    });
  };
  add_rigid("rigid back: press 30 N", as_press);
  add_rigid("rigid back: rub 30 N", as_rub);
  add_rigid("rigid back: stroke 30 N", as_stroke);
  add("contact lost at 40 N, 50 mm at 0.5 m/s", 40.0,
      {.highest_n = 90.0, .max_speed_m_per_s = 0.25, .second_impact_n = 30.0},
      [](auto& experiment) { experiment.shifts = {person_moves(-50.0, 0.5)}; });
  for (const double force_n : {30.0, 40.0}) {
    add(force_n < 35.0 ? "person rises 30 mm at 0.1 m/s, 30 N"
                       : "person rises 30 mm at 0.1 m/s, 40 N",
        force_n, {.highest_n = 75.0},
        [](auto& experiment) { experiment.shifts = {person_moves(30.0, 0.1)}; });
  }
  add("person slides 50 mm at 50 mm/s, 30 N", 30.0, within(2.0, 6.0), [](auto& experiment) {
    experiment.shifts = {
        {.start_s = 1.5, .by_in_couch = Vector3(50_mm, 0, 0), .speed_m_per_s = 0.05}};
  });
  return table;
}

ControlTable events(bool full, std::uint64_t seed) {
  const int seeds = full ? 2 : 1;
  const std::vector<double> forces = full ? std::vector{30.0, 45.0, 60.0} : std::vector{45.0};
  ControlTable table{.name = "events",
                     .about =
                         "What a person may do while 30, 45 or 60 N press: `highest` is the "
                         "true force, `second` what comes after contact was lost.",
                     .rows = {}};
  struct Event {
    const char* what;
    double outward_mm, m_per_s, m_per_s2;
  };
  constexpr std::array<Event, 6> all = {{{"leaves 50 mm at 0.5 m/s", -50.0, 0.5, 0.0},
                                         {"rises 30 mm at 0.1 m/s", 30.0, 0.1, 0.0},
                                         {"coughs, 15 mm in 100 ms", 15.0, 0.3, 6.0},
                                         {"jumps 60 mm to 0.4 m/s with 1 g", 60.0, 0.4, 9.81},
                                         {"jumps 60 mm to 0.4 m/s with 2 g", 60.0, 0.4, 19.6},
                                         {"is at 0.4 m/s at once, 60 mm", 60.0, 0.4, 0.0}}};
  for (const Torso& torso : torsos) {
    for (const Event& event : all) {
      for (const double force_n : forces) {
        ControlRow row = on_all_tissues(event.what, force_n, seeds, seed, [&](auto& experiment) {
          experiment.shifts = {person_moves(event.outward_mm, event.m_per_s, event.m_per_s2)};
          experiment.torso_n_per_m = torso.n_per_m;
        });
        row.labels.emplace_back("torso", torso.name);
        row.labels.emplace_back("force_n", fmt::format("{:.0f}", force_n));
        table.rows.push_back(std::move(row));
      }
    }
  }
  return table;
}

ControlTable controllers(bool full, std::uint64_t seed) {
  ControlTable table{.name = "controllers",
                     .about =
                         "One press of 5 s by each controller on each tissue, torso, friction, "
                         "error of the surface and breath.",
                     .rows = {}};
  const std::vector<double> forces =
      full ? std::vector{10.0, 20.0, 40.0, 60.0} : std::vector{10.0, 40.0};
  const std::vector<double> frictions = full ? std::vector{0.0, 1.0} : std::vector{1.0};
  const std::vector<double> errors_m = full ? std::vector{0.0, 3_mm} : std::vector{3_mm};
  const std::vector<double> breaths_m = full ? std::vector{0.0, 3_mm} : std::vector{0.0};
  for (const ControllerChoice& choice : controller_choices())
    for (const NamedTissue& tissue : tissues)
      for (const double force_n : forces)
        for (const Torso& torso : torsos)
          for (const double friction : frictions)
            for (const double error_m : errors_m)
              for (const double breath_m : breaths_m) {
                ContactExperiment experiment = wrong_world(tissue.tissue, force_n, seed);
                choose(experiment, choice);
                experiment.torso_n_per_m = torso.n_per_m;
                experiment.friction_scale = friction;
                experiment.surface_error_m = error_m;
                experiment.breathing.amplitude_m = breath_m;
                table.rows.push_back(
                    {.labels = {{"controller", choice.name},
                                {"tissue", tissue.name},
                                {"force_n", fmt::format("{:.0f}", force_n)},
                                {"torso", torso.name},
                                {"friction", fmt::format("{:.0f}", friction)},
                                {"surface_error_mm", fmt::format("{:.0f}", to_mm(error_m))},
                                {"breathing_mm", fmt::format("{:.0f}", to_mm(breath_m))}},
                     .runs = {experiment}});
              }
  return table;
}

ControlTable curved(bool full, std::uint64_t seed) {
  ControlTable table{.name = "curved_back",
                     .about =
                         "Rubbing 30 N and stroking 15 N, along the spine and across the back, "
                         "whose radius is believed to be 0.4 m and whose lean is not known.",
                     .rows = {}};
  struct Motion {
    const char* name;
    Technique technique;
    double force_n;
    bool across = false;
    RubShape shape = RubShape::circle;
  };
  constexpr std::array<Motion, 5> motions = {
      {{"rub, circle", Technique::rub, 30.0},
       {"rub, ellipse", Technique::rub, 30.0, false, RubShape::ellipse},
       {"rub, spiral", Technique::rub, 30.0, false, RubShape::spiral},
       {"stroke along", Technique::stroke, 15.0},
       {"stroke across", Technique::stroke, 15.0, true}}};
  const std::vector<double> radii_m = full ? std::vector{0.2, 0.3, 0.6} : std::vector{0.3};
  const std::vector<double> breaths_m = full ? std::vector{0.0, 3_mm, 12_mm} : std::vector{12_mm};
  for (const Motion& motion : motions)
    for (const double radius_m : radii_m)
      for (const double tilt_deg : {0.0, 5.0})
        for (const double breath_m : breaths_m) {
          ControlRow row = on_all_tissues(motion.name, motion.force_n, 1, seed, [&](auto& run) {
            run.technique = motion.technique;
            run.stroke_across = motion.across;
            run.rub_shape = motion.shape;
            run.duration_s = 8.0;
            run.bend_radius_m = radius_m;
            run.believed_bend_radius_m = 0.4;
            run.surface_tilt_rad = from_deg(tilt_deg);
            run.breathing = {breath_m, 0.25};
          });
          row.labels.emplace_back("radius_m", fmt::format("{:.1f}", radius_m));
          row.labels.emplace_back("lean_deg", fmt::format("{:.0f}", tilt_deg));
          row.labels.emplace_back("breathing_mm", fmt::format("{:.0f}", to_mm(breath_m)));
          table.rows.push_back(std::move(row));
        }
  return table;
}

ControlTable taps(std::uint64_t seed) {
  ControlTable table{.name = "taps", .about = "Tapping without leaving the skin.", .rows = {}};
  for (const double rate_hz : {1.0, 3.0, 5.0})
    for (const double force_n : {6.0, 10.0}) {
      ControlRow row =
          on_all_tissues(fmt::format("tap {:.0f} N", force_n), force_n, 1, seed, [&](auto& run) {
            run.technique = Technique::tap;
            run.tap_hz = rate_hz;
          });
      row.labels.emplace_back("rate_hz", fmt::format("{:.0f}", rate_hz));
      table.rows.push_back(std::move(row));
    }
  return table;
}

}  // namespace

const std::vector<ControllerChoice>& controller_choices() {
  static const std::vector<ControllerChoice> all = {
      {"joint", control::Law::joint, 0.0},
      {"thesis M_e 1 kg", control::Law::thesis, 1.0},
      {"thesis M_e 4 kg", control::Law::thesis, 4.0},
      {"without trim", control::Law::virtual_target, 0.0},
      {"tuina", control::Law::tuina, 0.0}};
  return all;
}

void choose(ContactExperiment& experiment, const ControllerChoice& choice) {
  experiment.controller.law = choice.law;
  if (choice.law == control::Law::thesis)
    experiment.controller.thesis = {.mass_kg = choice.mass_kg, .below_apparent_mass = true};
}

std::vector<ControlTable> control_tables(bool full, std::uint64_t seed) {
  const int seeds = full ? 4 : 1;
  return {targets(seeds, seed),
          events(full, seed),
          controllers(full, seed),
          curved(full, seed),
          taps(seed),
          stiffness_table(full, seed),
          devices_table(seed),
          stability_table(full, seed),
          rules_table(seed)};
}

}  // namespace tuina::app
