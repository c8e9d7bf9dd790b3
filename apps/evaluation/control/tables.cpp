// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

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
  const auto add = [&](const std::string& what, double force_n, const ControlTarget& target,
                       const std::function<void(ContactExperiment&)>& set) {
    table.rows.push_back(
        varied({on_all_tissues(force_n, seeds, seed)}, "what", {{what, set}}).front());
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
    add(fmt::format("person rises 30 mm at 0.1 m/s, {:.0f} N", force_n), force_n,
        {.highest_n = 75.0},
        [](auto& experiment) { experiment.shifts = {person_moves(30.0, 0.1)}; });
  }
  add("person slides 50 mm at 50 mm/s, 30 N", 30.0, within(2.0, 6.0), [](auto& experiment) {
    experiment.shifts = {
        {.start_s = 1.5, .by_in_couch = Vector3(50_mm, 0, 0), .speed_m_per_s = 0.05}};
  });
  return table;
}

ControlTable events(bool full, std::uint64_t seed) {
  const auto moves = [](const char* what, double outward_mm, double m_per_s,
                        double m_per_s2 = 0.0) {
    return Choice{what,
                  [=](auto& run) { run.shifts = {person_moves(outward_mm, m_per_s, m_per_s2)}; }};
  };
  auto rows = varied({on_all_tissues(0.0, full ? 2 : 1, seed)}, "torso", torsos());
  rows = varied(
      rows, "what",
      {moves("leaves 50 mm at 0.5 m/s", -50.0, 0.5), moves("rises 30 mm at 0.1 m/s", 30.0, 0.1),
       moves("coughs, 15 mm in 100 ms", 15.0, 0.3, 6.0),
       moves("jumps 60 mm to 0.4 m/s with 1 g", 60.0, 0.4, 9.81),
       moves("jumps 60 mm to 0.4 m/s with 2 g", 60.0, 0.4, 19.6),
       moves("is at 0.4 m/s at once, 60 mm", 60.0, 0.4)});
  return {.name = "events",
          .about =
              "What a person may do while 30, 45 or 60 N press: `highest` is the true force, "
              "`second` what comes after contact was lost.",
          .rows = varied(rows, "force_n",
                         forces(full ? std::vector{30.0, 45.0, 60.0} : std::vector{45.0}))};
}

ControlTable controllers(bool full, std::uint64_t seed) {
  std::vector<Choice> laws;
  for (const ControllerChoice& law : controller_choices())
    laws.push_back({law.name, [law](auto& run) { choose(run, law); }});
  const auto either = [full](double always, double in_full) {
    return full ? std::vector{in_full, always} : std::vector{always};
  };
  auto rows = varied({{.labels = {}, .runs = {wrong_world(0.0, seed)}}}, "controller", laws);
  rows = varied(rows, "tissue", all_tissues());
  rows = varied(rows, "force_n",
                forces(full ? std::vector{10.0, 20.0, 40.0, 60.0} : std::vector{10.0, 40.0}));
  rows = varied(rows, "torso", torsos());
  rows = varied(rows, "friction", numbers(either(1.0, 0.0), [](auto& run, double scale) {
                  run.friction_scale = scale;
                }));
  rows = varied(rows, "surface_error_mm", numbers(either(3.0, 0.0), [](auto& run, double mm) {
                  run.surface_error_m = from_mm(mm);
                }));
  rows = varied(rows, "breathing_mm",
                numbers(full ? std::vector{0.0, 3.0} : std::vector{0.0},
                        [](auto& run, double mm) { run.breathing.amplitude_m = from_mm(mm); }));
  return {.name = "controllers",
          .about =
              "One press of 5 s by each controller on each tissue, torso, friction, error of the "
              "surface and breath.",
          .rows = std::move(rows)};
}

ControlTable curved(bool full, std::uint64_t seed) {
  ControlRow row = on_all_tissues(0.0, 1, seed);
  for (ContactExperiment& run : row.runs) {
    run.duration_s = 8.0;
    run.believed_bend_radius_m = 0.4;
  }
  const auto rub = [](RubShape shape) {
    return [shape](ContactExperiment& run) {
      run.technique = Technique::rub;
      run.force_n = 30.0;
      run.rub_shape = shape;
    };
  };
  const auto stroke = [](bool across) {
    return [across](ContactExperiment& run) {
      run.technique = Technique::stroke;
      run.force_n = 15.0;
      run.stroke_across = across;
    };
  };
  auto rows = varied({row}, "what",
                     {{"rub, circle", rub(RubShape::circle)},
                      {"rub, ellipse", rub(RubShape::ellipse)},
                      {"rub, spiral", rub(RubShape::spiral)},
                      {"stroke along", stroke(false)},
                      {"stroke across", stroke(true)}});
  rows = varied(rows, "radius_m",
                numbers(full ? std::vector{0.2, 0.3, 0.6} : std::vector{0.3},
                        [](auto& run, double radius_m) { run.bend_radius_m = radius_m; }));
  rows = varied(rows, "lean_deg", numbers({0.0, 5.0}, [](auto& run, double lean_deg) {
                  run.surface_tilt_rad = from_deg(lean_deg);
                }));
  rows = varied(
      rows, "breathing_mm",
      numbers(full ? std::vector{0.0, 3.0, 12.0} : std::vector{12.0}, [](auto& run, double mm) {
        run.breathing = {from_mm(mm), 0.25};
      }));
  return {.name = "curved_back",
          .about =
              "Rubbing 30 N and stroking 15 N, along the spine and across the back, whose radius "
              "is believed to be 0.4 m and whose lean is not known.",
          .rows = std::move(rows)};
}

ControlTable taps(std::uint64_t seed) {
  const auto tap = [](double force_n) {
    return Choice{fmt::format("tap {:.0f} N", force_n), [force_n](auto& run) {
                    run.technique = Technique::tap;
                    run.force_n = force_n;
                  }};
  };
  const auto rates = numbers({1.0, 3.0, 5.0}, [](auto& run, double hz) { run.tap_hz = hz; });
  return {.name = "taps",
          .about = "Tapping without leaving the skin.",
          .rows = varied(varied({on_all_tissues(0.0, 1, seed)}, "rate_hz", rates), "what",
                         {tap(6.0), tap(10.0)})};
}

}  // namespace

const std::vector<ControllerChoice>& controller_choices() {
  static const std::vector<ControllerChoice> all = {
      {"joint", control::ControlLaw::joint, 0.0},
      {"thesis M_e 1 kg", control::ControlLaw::thesis, 1.0},
      {"thesis M_e 4 kg", control::ControlLaw::thesis, 4.0},
      {"without trim", control::ControlLaw::virtual_target, 0.0},
      {"tuina", control::ControlLaw::tuina, 0.0}};
  return all;
}

void choose(ContactExperiment& experiment, const ControllerChoice& choice) {
  experiment.controller.law = choice.law;
  if (choice.law == control::ControlLaw::thesis)
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
          rules_table(seed),
          position_table(full ? 4 : 1, seed),
          position_targets_table(targets(seeds, seed)),
          position_hold_table(seed),
          position_faults_table(seed)};
}

}  // namespace tuina::app
