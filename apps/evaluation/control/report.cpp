// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

nlohmann::ordered_json json_of(const ControlRow& row) {
  nlohmann::ordered_json json;
  for (const auto& [name, value] : row.labels) json[name] = value;
  const ControlResult& result = row.result;
  json["runs"] = result.runs;
  json["stopped"] = result.stopped;
  json["rmse_n"] = result.rmse_n;
  json["overshoot_n"] = result.overshoot_n;
  json["ripple_n"] = result.ripple_n;
  json["highest_n"] = result.highest_n;
  json["fastest_mm_per_s"] = to_mm(result.max_speed_m_per_s);
  json["second_impact_n"] = result.second_impact_n;
  if (row.target) {
    const auto limit = [&](const char* key, const std::optional<double>& value, double scale) {
      if (value) json["target"][key] = scale * *value;
    };
    limit("rmse_n", row.target->rmse_n, 1.0);
    limit("overshoot_n", row.target->overshoot_n, 1.0);
    limit("highest_n", row.target->highest_n, 1.0);
    limit("fastest_mm_per_s", row.target->max_speed_m_per_s, 1e3);
    limit("second_impact_n", row.target->second_impact_n, 1.0);
    json["reached"] = row.target->reached(result);
  }
  return json;
}

std::string line_of(const ControlRow& row) {
  std::string what;
  for (const auto& [name, value] : row.labels) what += (what.empty() ? "" : ", ") + value;
  const ControlResult& r = row.result;
  return fmt::format("{:<52} {:6.2f} {:6.1f} {:6.1f} {:6.0f} {:6.1f} {:>5}/{}{}\n", what, r.rmse_n,
                     r.overshoot_n, r.highest_n, to_mm(r.max_speed_m_per_s), r.second_impact_n,
                     r.stopped, r.runs,
                     !row.target              ? ""
                     : row.target->reached(r) ? "  reached"
                                              : "  NOT REACHED");
}

}  // namespace

const ControlTable* ControlReport::table(const std::string& name) const {
  const auto found = std::find_if(tables.begin(), tables.end(),
                                  [&](const ControlTable& table) { return table.name == name; });
  return found == tables.end() ? nullptr : &*found;
}

std::string to_json(const ControlReport& report) {
  nlohmann::ordered_json json = {{"seed", report.seed}, {"full", report.full}};
  for (const ControlTable& table : report.tables) {
    auto& rows = json["control"][table.name] = nlohmann::ordered_json::array();
    for (const ControlRow& row : table.rows) rows.push_back(json_of(row));
  }
  for (const BeyondReach& pull : report.beyond_reach) {
    json["control"]["beyond_reach"].push_back({{"law", pull.law},
                                               {"highest_torque_nm", pull.max_torque_nm},
                                               {"fastest_rad_per_s", pull.max_speed_rad_per_s},
                                               {"survived", pull.survived}});
  }
  for (const ReflexBound& bound : report.reflex_bounds) {
    json["control"]["reflex_bound"].push_back({{"tissue", bound.tissue},
                                               {"force_n", bound.force_n},
                                               {"after_ms", bound.after_ms},
                                               {"push_n", bound.push_n},
                                               {"highest_n", bound.highest_n}});
  }
  const ForceAtTool& force = report.force_at_tool;
  json["control"]["force_at_tool"] = {{"places", force.places},
                                      {"reached", force.reached},
                                      {"least_n", force.min_n},
                                      {"median_n", force.median_n},
                                      {"reach_m", force.reach_m}};
  return json.dump(2);
}

std::string to_text(const ControlReport& report) {
  std::string text = fmt::format(
      "The worst of all runs of a row; errors of the true contact force. Simulation only.\n{:<52} "
      "{:>6} {:>6} {:>6} {:>6} {:>6} {:>7}\n{:<52} {:>6} {:>6} {:>6} {:>6} {:>6}\n",
      "", "rmse", "over", "high", "fast", "second", "stopped", "", "N", "N", "N", "mm/s", "N");
  for (const ControlTable& whole : report.tables) {
    const bool many = whole.name == "controllers";
    const ControlTable table = many ? grouped(whole, {"controller", "torso", "force_n"}) : whole;
    text += fmt::format("\n{}\n", table.about);
    for (const ControlRow& row : table.rows) text += line_of(row);
  }
  text += "\nA target 0.2 m beyond the stretched arm:\n";
  for (const BeyondReach& pull : report.beyond_reach) {
    text += fmt::format("{:<52} {:.3g} Nm, {:.3g} rad/s{}\n", pull.law, pull.max_torque_nm,
                        pull.max_speed_rad_per_s, pull.survived ? "" : ", diverges");
  }
  text += "\nA person on a rigid torso rises at 0.1 m/s against an arm that pushes itself away:\n";
  for (const ReflexBound& bound : report.reflex_bounds) {
    text += fmt::format("{:<52} {:6.0f} N\n",
                        fmt::format("{}, {:.0f} N, after {:.1f} ms with {:.0f} N", bound.tissue,
                                    bound.force_n, bound.after_ms, bound.push_n),
                        bound.highest_n);
  }
  text += fmt::format(
      "\nForce that the drives hold on a seated back, {} of {} places reached: {:.0f} N at the "
      "weakest place, {:.0f} N in the median. Reach {:.2f} m.",
      report.force_at_tool.reached, report.force_at_tool.places, report.force_at_tool.min_n,
      report.force_at_tool.median_n, report.force_at_tool.reach_m);
  return text;
}

}  // namespace tuina::app
