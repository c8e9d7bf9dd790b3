// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/acupoints/scores.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;
using telemetry::Cell;
using telemetry::Column;
using telemetry::Table;

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto nearest = std::lround(share * static_cast<double>(values.size() - 1));
  return values[static_cast<std::size_t>(nearest)];
}

/// The share of the chosen points that lie within their radius; null for a method that states none.
template <typename Chosen>
json coverage(const Score& score, const Chosen& chosen) {
  double covered = 0.0;
  double counted = 0.0;
  for (const Finding& finding : score.findings) {
    if (!chosen(finding) || finding.uncertainty_mm <= 0.0) continue;
    counted += 1.0;
    covered += finding.error_mm <= finding.uncertainty_mm ? 1.0 : 0.0;
  }
  return counted > 0.0 ? json(covered / counted) : json();
}

template <typename Chosen>
json summary(const Score& score, const Chosen& chosen) {
  std::vector<double> errors;
  Vector3 squared = Vector3::Zero();
  for (const Finding& finding : score.findings) {
    if (!chosen(finding)) continue;
    errors.push_back(finding.error_mm);
    squared +=
        to_mm(1.0) * to_mm(1.0) * (finding.found_in_couch - finding.true_in_couch).cwiseAbs2();
  }
  if (errors.empty()) return nullptr;
  const auto count = static_cast<double>(errors.size());
  const double mean = mean_of(errors);
  double variance = 0.0;
  for (const double error : errors) variance += (error - mean) * (error - mean) / count;
  const Vector3 rmse = (squared / count).cwiseSqrt();
  return {{"mean_mm", mean},
          {"sd_mm", std::sqrt(variance)},
          {"p95_mm", quantile_of(errors, 0.95)},
          {"max_mm", quantile_of(errors, 1.0)},
          {"rmse_mm", {{"x", rmse.x()}, {"y", rmse.y()}, {"z", rmse.z()}}},
          {"coverage", coverage(score, chosen)}};
}

std::vector<Column> spread_columns(const char* first) {
  std::vector<Column> columns = {{.head = first}};
  for (const char* head : {"mean", "SD", "95 %", "max", "x RMSE", "y RMSE", "z RMSE"})
    columns.push_back({.head = head, .digits = 1});
  return columns;
}

std::vector<Cell> spread_cells(const char* first, const json& group) {
  const json rmse = group.is_object() ? group.value("rmse_mm", json()) : json();
  return {first,
          number_in(group, "mean_mm"),
          number_in(group, "sd_mm"),
          number_in(group, "p95_mm"),
          number_in(group, "max_mm"),
          number_in(rmse, "x"),
          number_in(rmse, "y"),
          number_in(rmse, "z")};
}

}  // namespace

json to_json(const Score& score) {
  const auto seven = [](const Finding& f) { return f.of_the_seven; };
  json row = summary(score, seven);
  if (row.is_null()) row = json::object();
  for (const char* position : {"sitting", "prone"}) {
    row["by_position"][position] =
        summary(score, [&](const Finding& f) { return f.of_the_seven && f.position == position; });
    for (const char* type : {"slim", "medium", "hefty"}) {
      row["by_position_and_type"][position][type] = summary(score, [&](const Finding& f) {
        return f.of_the_seven && f.position == position && f.type == type;
      });
    }
  }
  for (const char* type : {"slim", "medium", "hefty"}) {
    row["by_type"][type] =
        summary(score, [&](const Finding& f) { return f.of_the_seven && f.type == type; });
  }
  for (const char* arms : {"up", "down"}) {
    row["prone_by_arms"][arms] = summary(score, [&](const Finding& f) {
      return f.of_the_seven && f.position == "prone" && f.arms == arms;
    });
  }
  for (const char* point : seven_acupoints) {
    row["by_point"][point] = summary(score, [&](const Finding& f) { return f.point == point; });
  }
  row["all_points"] = summary(score, [](const Finding&) { return true; });
  row["coverage"] = coverage(score, seven);
  double silent = 0.0;
  for (const Finding& f : score.findings) {
    if (f.of_the_seven && f.uncertainty_mm > 0.0 && f.error_mm > 3.0 * f.uncertainty_mm) ++silent;
  }
  row["beyond_three_radii"] = silent;
  row["failures"] = score.failures.size();
  row["failed"] = score.failures;
  row["compute_ms_median"] = quantile_of(score.compute_ms, 0.5);
  return row;
}

json to_json(const Times& times) {
  const auto median = [](const std::vector<double>& values) {
    return values.empty() ? json() : json(quantile_of(values, 0.5));
  };
  json row{{"scan_s", median(times.scan_s)},
           {"map_s", median(times.map_s)},
           {"plan_s", median(times.plan_s)},
           {"thesis_s", 35.0},
           {"teach_and_play_s", 75.0}};
  const bool all = !times.scan_s.empty() && !times.map_s.empty() && !times.plan_s.empty();
  row["total_s"] = all ? json(quantile_of(times.scan_s, 0.5) + quantile_of(times.map_s, 0.5) +
                              quantile_of(times.plan_s, 0.5))
                       : json();
  return row;
}

Cell number_in(const json& group, const char* key, double scale) {
  const json value = group.is_object() ? group.value(key, json()) : json();
  return value.is_number() ? scale * value.get<double>() : std::nan("");
}

Table place_table(const json& methods) {
  Table table{.columns = {{.head = "mean, mm"}}};
  for (const char* head :
       {"sitting", "slim", "medium", "hefty", "prone", "slim", "medium", "hefty", "all points"})
    table.columns.push_back({.head = head, .digits = 1});
  for (const char* method : acupoint_methods) {
    if (!methods.contains(method)) continue;
    const json& row = methods[method];
    std::vector<Cell> cells = {method};
    for (const char* position : {"sitting", "prone"}) {
      cells.push_back(number_in(row["by_position"][position], "mean_mm"));
      for (const char* type : {"slim", "medium", "hefty"})
        cells.push_back(number_in(row["by_position_and_type"][position][type], "mean_mm"));
    }
    cells.push_back(number_in(row["all_points"], "mean_mm"));
    table.add(std::move(cells));
  }
  return table;
}

Table spread_table(const json& methods) {
  Table table{.columns = spread_columns("mm")};
  table.columns.push_back({.head = "within the radius, %", .digits = 0});
  table.columns.push_back({.head = "failures"});
  table.columns.push_back({.head = "ms", .digits = 0});
  for (const char* method : acupoint_methods) {
    if (!methods.contains(method)) continue;
    const json& row = methods[method];
    std::vector<Cell> cells = spread_cells(method, row);
    cells.push_back(number_in(row, "coverage", 100.0));
    cells.emplace_back(row["failures"].get<std::size_t>());
    cells.push_back(number_in(row, "compute_ms_median"));
    table.add(std::move(cells));
  }
  return table;
}

Table point_table(const json& method) {
  Table table{.columns = spread_columns("point")};
  for (const char* point : seven_acupoints)
    table.add(spread_cells(point, method["by_point"][point]));
  return table;
}

json palpated_json(const std::map<std::string, Score>& scores) {
  json sets = json::object();
  for (const auto& names : palpated_sets) {
    const auto follows = [&](const Finding& f) {
      return f.of_the_seven && std::find(names.begin(), names.end(), f.point) == names.end();
    };
    const auto found = scores.find(name_of(names));
    if (found == scores.end()) continue;
    const json before = summary(scores.at("surface"), follows);
    json row = summary(found->second, follows);
    if (row.is_null()) row = json::object();
    for (const char* position : {"sitting", "prone"}) {
      row["by_position"][position] = summary(
          found->second, [&](const Finding& f) { return follows(f) && f.position == position; });
    }
    row["share"] = nullptr;
    if (before.is_object() && row.contains("mean_mm"))
      row["share"] = row["mean_mm"].get<double>() / before["mean_mm"].get<double>();
    row["failures"] = found->second.failures.size();
    row["failed"] = found->second.failures;
    sets[name_of(names)] = std::move(row);
  }
  return sets;
}

Table palpated_table(const std::map<std::string, Score>& scores) {
  Table table{.note = fmt::format("a finger that errs by {:.0f} mm in each direction of the skin",
                                  finger_error_mm),
              .columns = {{.head = "palpated: the others, mm"}}};
  for (const char* head : {"sitting", "prone", "95 %", "max"})
    table.columns.push_back({.head = head, .digits = 1});
  for (const char* head : {"of the error before, %", "within the radius, %"})
    table.columns.push_back({.head = head, .digits = 0});
  table.columns.push_back({.head = "refused", .digits = 0});
  const json sets = palpated_json(scores);
  for (const auto& names : palpated_sets) {
    const json row = sets.value(name_of(names), json::object());
    const json by_position = row.value("by_position", json::object());
    table.add({name_of(names), number_in(by_position.value("sitting", json()), "mean_mm"),
               number_in(by_position.value("prone", json()), "mean_mm"), number_in(row, "p95_mm"),
               number_in(row, "max_mm"), number_in(row, "share", 100.0),
               number_in(row, "coverage", 100.0), number_in(row, "failures")});
  }
  return table;
}

Table time_table(const json& times) {
  Table table{.columns = {{.head = "median"}}};
  std::vector<Cell> cells = {"seconds"};
  for (const auto& [head, key] :
       {std::pair{"scan", "scan_s"}, std::pair{"map", "map_s"}, std::pair{"plan", "plan_s"},
        std::pair{"all", "total_s"}, std::pair{"thesis", "thesis_s"},
        std::pair{"teach and play", "teach_and_play_s"}}) {
    table.columns.push_back({.head = head, .digits = 2});
    cells.push_back(number_in(times, key));
  }
  table.add(std::move(cells));
  return table;
}

}  // namespace tuina::app
