// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/cli/table.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using telemetry::Cell;
using telemetry::Column;
using telemetry::Table;

/// The names of all labels, in the order in which they come; rows may have different ones.
std::vector<std::string> labels_of(const ControlTable& table) {
  std::vector<std::string> names;
  for (const ControlRow& row : table.rows) {
    for (const auto& label : row.labels) {
      if (std::find(names.begin(), names.end(), label.first) == names.end())
        names.push_back(label.first);
    }
  }
  return names;
}

std::vector<Column> columns_of(const ControlTable& table) {
  std::vector<Column> columns;
  for (const std::string& name : labels_of(table)) {
    std::string head = name == "what" ? " " : name;
    std::replace(head.begin(), head.end(), '_', ' ');
    columns.push_back({.head = head, .key = name});
  }
  const bool judged = std::any_of(table.rows.begin(), table.rows.end(),
                                  [](const ControlRow& row) { return row.target.has_value(); });
  const std::vector<Column> results = {
      {.head = "runs", .key = "runs"},
      {.head = "stopped", .key = "stopped"},
      {.head = "error, N rms", .key = "rmse_n", .digits = 2},
      {.head = "over target, N", .key = "overshoot_n", .digits = 1},
      {.head = "ripple, N", .key = "ripple_n", .digits = 2},
      {.head = "highest, N", .key = "highest_n", .digits = 1},
      {.head = "tool, mm/s", .key = "fastest_mm_per_s", .digits = 0},
      {.head = "second contact, N", .key = "second_impact_n", .digits = 1},
      {.key = "target.rmse_n"},
      {.key = "target.overshoot_n"},
      {.key = "target.highest_n"},
      {.key = "target.fastest_mm_per_s"},
      {.key = "target.second_impact_n"},
      {.key = "reached"},
      {.head = judged ? "target" : ""}};
  columns.insert(columns.end(), results.begin(), results.end());
  return columns;
}

std::vector<Cell> cells_of(const ControlRow& row, const std::vector<std::string>& labels) {
  std::vector<Cell> cells(labels.size());
  for (const auto& [name, value] : row.labels) {
    const auto column = std::find(labels.begin(), labels.end(), name) - labels.begin();
    cells[static_cast<std::size_t>(column)] = value;
  }
  const ControlResult& r = row.result;
  cells.insert(cells.end(), {r.runs, r.stopped, r.rmse_n, r.overshoot_n, r.ripple_n, r.highest_n,
                             to_mm(r.max_speed_m_per_s), r.second_impact_n});
  if (!row.target) {
    cells.resize(cells.size() + 7);
    return cells;
  }
  const ControlTarget& target = *row.target;
  const Cell speed = target.max_speed_m_per_s ? Cell(to_mm(*target.max_speed_m_per_s)) : Cell();
  const bool reached = target.reached(r);
  cells.insert(cells.end(), {target.rmse_n, target.overshoot_n, target.highest_n, speed,
                             target.second_impact_n, reached, reached ? "reached" : "NOT REACHED"});
  return cells;
}

Table table_of(const ControlTable& table) {
  Table rows{.note = table.about};
  rows.columns = columns_of(table);
  const auto labels = labels_of(table);
  for (const ControlRow& row : table.rows) rows.add(cells_of(row, labels));
  return rows;
}

}  // namespace

const ControlTable* ControlReport::table(const std::string& name) const {
  const auto found = std::find_if(tables.begin(), tables.end(),
                                  [&](const ControlTable& table) { return table.name == name; });
  return found == tables.end() ? nullptr : &*found;
}

Table shown_table(const ControlTable& table) {
  const bool many = table.name == "controllers";
  return table_of(many ? grouped(table, {"controller", "torso", "force_n"}) : table);
}

Table beyond_reach_table(const ControlReport& report) {
  Table table{.title = "A target 0.2 m beyond the stretched arm",
              .columns = {{.head = "law", .key = "law"},
                          {.head = "torque, Nm", .key = "highest_torque_nm"},
                          {.head = "joint, rad/s", .key = "fastest_rad_per_s"},
                          {.key = "survived"},
                          {.head = "outcome"}}};
  for (const BeyondReach& pull : report.beyond_reach) {
    table.add({pull.law, pull.max_torque_nm, pull.max_speed_rad_per_s, pull.survived,
               pull.survived ? "" : "diverges"});
  }
  return table;
}

Table reflex_table(const ControlReport& report) {
  Table table{.title =
                  "A person on a rigid torso rises at 0.1 m/s against an arm that pushes "
                  "itself away",
              .columns = {{.head = "tissue", .key = "tissue"},
                          {.head = "held, N", .key = "force_n", .digits = 0},
                          {.head = "answer after, ms", .key = "after_ms", .digits = 1},
                          {.head = "push, N", .key = "push_n", .digits = 0},
                          {.head = "highest force, N", .key = "highest_n", .digits = 0}}};
  for (const ReflexBound& bound : report.reflex_bounds)
    table.add({bound.tissue, bound.force_n, bound.after_ms, bound.push_n, bound.highest_n});
  return table;
}

std::string force_sentence(const ForceAtTool& force) {
  return fmt::format(
      "On a seated person's back the drives hold {:.0f} N at the weakest of {} places out of {} "
      "and "
      "{:.0f} N in the median. The stretched arm reaches {:.2f} m.",
      force.min_n, force.reached, force.places, force.median_n, force.reach_m);
}

std::string to_json(const ControlReport& report) {
  nlohmann::ordered_json json = {
      {"seed", report.seed}, {"full", report.full}, {"realism", report.realism}};
  nlohmann::ordered_json& control = json["control"];
  for (const ControlTable& table : report.tables) control[table.name] = to_json(table_of(table));
  control["beyond_reach"] = to_json(beyond_reach_table(report));
  control["reflex_bound"] = to_json(reflex_table(report));
  const ForceAtTool& force = report.force_at_tool;
  control["force_at_tool"] = {{"places", force.places},
                              {"reached", force.reached},
                              {"least_n", force.min_n},
                              {"median_n", force.median_n},
                              {"reach_m", force.reach_m}};
  return json.dump(2);
}

std::string to_text(const ControlReport& report) {
  std::string text =
      "The worst of all runs of a row; errors of the true contact force. Simulation only.\n";
  for (const ControlTable& table : report.tables) text += "\n" + to_text(shown_table(table));
  return text + "\n" + to_text(beyond_reach_table(report)) + "\n" + to_text(reflex_table(report)) +
         "\n" + force_sentence(report.force_at_tool);
}

}  // namespace tuina::app
