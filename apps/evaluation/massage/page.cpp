// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/massage/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

namespace paint = telemetry::palette;

/// One value of every session, sorted, against what it must keep to.
std::string sorted_plot(const char* title, const char* label, std::vector<double> values,
                        double bound) {
  std::sort(values.begin(), values.end());
  telemetry::Plot plot{.title = title,
                       .x_label = "share, %",
                       .y_label = label,
                       .x_low = 0.0,
                       .x_high = 100.0,
                       .width_px = 500,
                       .height_px = 240};
  telemetry::Series line{.name = "", .colour = paint::press, .width_px = 2.2};
  for (std::size_t i = 0; i < values.size(); ++i) {
    line.x.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(values.size()));
    line.y.push_back(values[i]);
  }
  plot.series.push_back({.name = "bound",
                         .x = {0.0, 100.0},
                         .y = {bound, bound},
                         .colour = paint::grey,
                         .dashed = true});
  plot.series.push_back(std::move(line));
  return telemetry::to_svg(plot);
}

std::vector<telemetry::Figure> plots_of(const std::vector<SessionOutcome>& outcomes) {
  std::vector<double> rmse_n, over_n, apart_mm, off_mm;
  for (const SessionOutcome& one : outcomes) {
    if (!one.refused.empty()) continue;
    rmse_n.push_back(one.rmse_n);
    over_n.push_back(one.over_trip_n);
    apart_mm.push_back(to_mm(one.arm_distance_m));
    for (const double off_m : one.tool_to_acupoint_m) off_mm.push_back(to_mm(off_m));
  }
  return {
      {sorted_plot("force error of the sessions", "force error, N RMS", rmse_n, 1.5)},
      {sorted_plot("force beyond what the zone bears", "over what the zone bears, N", over_n, 0.0)},
      {sorted_plot("distance between the arms", "arms apart, mm", apart_mm, 25.0)},
      {sorted_plot("from the tool to the true acupoint", "tool to acupoint, mm", off_mm, 17.0)}};
}

}  // namespace

telemetry::Table session_table(const std::vector<SessionRow>& rows) {
  telemetry::Table table{
      .columns = {{.head = "programme"},
                  {.head = "sessions", .key = "sessions"},
                  {.head = "refused", .key = "refused"},
                  {.head = "stopped", .key = "stopped"},
                  {.key = "with_trouble"},
                  {.key = "paths_left_out"},
                  {.head = "duration, s", .key = "duration_s", .digits = 0},
                  {.head = "force error, N RMS", .key = "force_rmse_n.mean", .digits = 2},
                  {.head = "worst", .key = "force_rmse_n.worst", .digits = 2},
                  {.head = "over the target, N", .key = "overshoot_n", .digits = 1},
                  {.key = "over_zone_cap_n"},
                  {.head = "over what the zone bears, N", .key = "over_zone_trip_n", .digits = 1},
                  {.head = "outside planned contacts, N", .key = "unplanned_n", .digits = 1},
                  {.head = "peak where bone is near, N", .key = "bony_peak_n", .digits = 1},
                  {.head = "arms apart, mm", .key = "min_arm_distance_mm", .digits = 0},
                  {.head = "tool to point, mm", .key = "tool_to_acupoint_mm.mean", .digits = 1},
                  {.head = "largest", .key = "tool_to_acupoint_mm.max", .digits = 1},
                  {.key = "scan_to_touch_s"},
                  {.key = "plan_ms"},
                  {.key = "real_time_factor"}}};
  for (const auto& [name, sum] : rows) {
    table.add({name,
               sum.sessions,
               sum.refused,
               sum.stopped,
               sum.troubled,
               sum.paths_left_out,
               sum.mean_duration_s,
               sum.mean_rmse_n,
               sum.worst_rmse_n,
               sum.worst_overshoot_n,
               sum.max_over_cap_n,
               sum.max_over_trip_n,
               sum.max_unplanned_n,
               sum.bony_peak_n,
               to_mm(sum.min_arm_distance_m),
               to_mm(sum.mean_tool_to_acupoint_m),
               to_mm(sum.max_tool_to_acupoint_m),
               sum.worst_scan_to_touch_s,
               sum.worst_plan_ms,
               sum.median_real_time_factor});
  }
  return table;
}

std::string session_page(const std::vector<SessionRow>& rows,
                         const std::vector<SessionRow>& adaptive,
                         const std::vector<SessionOutcome>& outcomes,
                         const std::vector<std::string>& incidents) {
  const SessionSummary& all = rows.back().sum;
  telemetry::Page page(
      {.title = "Whole massages",
       .over = "tuina evaluate massage",
       .badges = {"simulation"},
       .heading = "Whole massages, judged by what only the simulation knows",
       .lead = fmt::format(
           "{} sessions from the scan to the last stroke: {} refused, {} stopped. "
           "The true force {}; the arms kept {:.0f} mm apart.",
           all.sessions, all.refused, all.stopped,
           all.max_over_trip_n > 0.0
               ? fmt::format("was {:.1f} N beyond what its place bears", all.max_over_trip_n)
               : fmt::format("never came nearer than {:.1f} N to what its place bears",
                             -all.max_over_trip_n),
           to_mm(all.min_arm_distance_m))});
  page.section("By programme",
               "Forces are true contact forces; zones are drawn from the true points.")
      .table(session_table(rows));
  std::vector<const SessionOutcome*> given;
  given.reserve(outcomes.size());
  for (const SessionOutcome& one : outcomes) given.push_back(&one);
  page.section("What was given of what was planned",
               "Largest true force of each press and tap, per cent of its plan.")
      .table(given_table(given));
  page.section("What was felt against the truth",
               "alpha and beta, per cent of those of the true first loading.")
      .table(felt_table(given));
  page.section("All of them, sorted", "Dashed: what must be kept.").figures(plots_of(outcomes));
  if (!adaptive.empty())
    page.section("What steering by the tissue changes",
                 "The same people and programmes with it and without.")
        .table(session_table(adaptive));
  telemetry::Part& troubles = page.section("What did not go as planned");
  if (incidents.empty()) troubles.calm("Nothing.");
  for (const std::string& incident : incidents) troubles.alarm(incident);
  return page.str();
}

}  // namespace tuina::app
