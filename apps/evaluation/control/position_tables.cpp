// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "apps/evaluation/control/worlds.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/robot/faulty_robot.hpp"

namespace tuina::app {
namespace {

constexpr const char* robot_name = "ur";

std::vector<Choice> loops() {
  std::vector<Choice> all = {{"torque", [](auto&) {}}};
  for (const sim::PositionLoop& loop : {sim::quick_loop, sim::slow_loop})
    all.push_back(
        {fmt::format("{:g} Hz", loop.cycle_hz), [loop](auto& run) { run.position = loop; }});
  return all;
}

ControlRow row_of(double force_n, int seeds, std::uint64_t first_seed) {
  ControlRow row{.labels = {}, .runs = {}};
  for (int k = 0; k < seeds; ++k) {
    row.runs.push_back(wrong_world(force_n, first_seed + static_cast<std::uint64_t>(k)));
    row.runs.back().robot = robot_name;
  }
  return row;
}

/// The targets of every arm in contact (`evaluate control --table targets`).
ControlTarget target_of(const ContactExperiment& run) {
  if (run.technique != Technique::press) return {.rmse_n = 1.0, .highest_n = 90.0};
  const bool light = run.force_n <= 30.0;
  return {.rmse_n = light ? 0.8 : 1.5, .overshoot_n = light ? 3.0 : 5.0, .highest_n = 90.0};
}

std::vector<ControlRow> with_targets(std::vector<ControlRow> rows) {
  for (ControlRow& row : rows) row.target = target_of(row.runs.front());
  return rows;
}

/// The left wrist fails so, in a press.
Choice wrist(const char* name, sim::RobotFault kind, double size) {
  return {name, [kind, size](ContactExperiment& run) {
            run.duration_s = 12.0;
            run.window = {.hold_s = 6.0};
            run.seen_as = [kind, size, faulty = std::shared_ptr<sim::FaultyRobot>()](
                              robot::Robot& arms) mutable -> robot::Robot& {
              faulty = std::make_shared<sim::FaultyRobot>(arms);
              faulty->add({.kind = kind, .size = size, .onset_s = 8.0});
              return *faulty;
            };
          }};
}

}  // namespace

// The contact tasks by an arm that takes torques and by the same arm where it takes places.
ControlTable position_table(int seeds, std::uint64_t first_seed) {
  const auto rub = [](ContactExperiment& run) {
    run.technique = Technique::rub;
    run.breathing = {3_mm, 0.25};
  };
  const auto stroke = [](ContactExperiment& run) { run.technique = Technique::stroke; };
  auto rows = varied({row_of(0.0, seeds, first_seed)}, "technique",
                     {{name_of(Technique::press), [](auto&) {}},
                      {name_of(Technique::rub), rub},
                      {name_of(Technique::stroke), stroke}});
  rows = varied(rows, "force_n", forces({10.0, 20.0, 30.0}));
  rows = varied(rows, "loop", loops());
  return {.name = "position",
          .about =
              "Contact by an arm that takes torques, and by the same arm where it takes places, in "
              "cycles of 500 Hz (20 Hz of bandwidth) and of 125 Hz (10 Hz).",
          .rows = with_targets(varied(rows, "tissue", all_tissues()))};
}

// What contact must hold, by an arm that takes torques and by the same arm where it takes places.
ControlTable position_targets_table(ControlTable targets) {
  for (ControlRow& row : targets.rows)
    for (ContactExperiment& run : row.runs) run.robot = robot_name;
  return {.name = "position_targets",
          .about = targets.about + " By an arm that takes torques, and where it takes places.",
          .rows = varied(targets.rows, "loop", loops())};
}

// The force that such an arm holds, by how quick it is.
ControlTable position_hold_table(std::uint64_t seed) {
  auto rows =
      varied({row_of(0.0, 1, seed)}, "cycle_hz", numbers({125.0, 500.0}, [](auto& run, double hz) {
               run.position = sim::PositionLoop{.cycle_hz = hz};
             }));
  rows = varied(rows, "bandwidth_hz", numbers({5.0, 10.0, 20.0, 40.0}, [](auto& run, double hz) {
                  run.position->bandwidth_hz = hz;
                }));
  rows = varied(rows, "force_n", forces({10.0, 20.0, 30.0, 45.0, 60.0}));
  return {.name = "position_hold",
          .about = "Presses by an arm that takes places: by its cycle and its bandwidth.",
          .rows = with_targets(varied(rows, "tissue", all_tissues()))};
}

// What a wrist that fails does to an arm whose force nothing bounds except that wrist.
ControlTable position_faults_table(std::uint64_t seed) {
  using sim::RobotFault;
  const auto rows = varied({row_of(20.0, 1, seed)}, "wrist",
                           {wrist("silent", RobotFault::wrench_dropout, 0.0),
                            wrist("stuck", RobotFault::wrench_stuck, 0.0),
                            wrist("reversed", RobotFault::wrench_flip, 0.0),
                            wrist("10 N more", RobotFault::wrench_bias, 10.0),
                            wrist("10 N less", RobotFault::wrench_bias, -10.0),
                            wrist("drifts by 5 N/s", RobotFault::wrench_drift, 5.0),
                            wrist("drifts by -5 N/s", RobotFault::wrench_drift, -5.0),
                            wrist("says 10 N at most", RobotFault::wrench_saturation, 10.0)});
  return {.name = "position_faults",
          .about = "A wrist sensor fails while 20 N press hard muscle: `highest` is true.",
          .rows = varied(rows, "loop", loops())};
}

}  // namespace tuina::app
