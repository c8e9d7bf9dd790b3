// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/massage/page.hpp"

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/style.hpp"

namespace tuina::app {
namespace {

namespace paint = telemetry::palette;

std::string table_of(const std::vector<SessionRow>& rows) {
  std::string html =
      "<div class=\"wide\"><table><thead><tr><th></th><th>sessions</th><th>refused</th>"
      "<th>stopped</th><th>force error,<br>N RMS, worst</th><th>over the<br>target, N</th>"
      "<th>over what the<br>zone bears, N</th><th>peak where<br>bone is near, N</th>"
      "<th>arms apart,<br>mm, least</th><th>tool to point,<br>mm, mean</th><th>largest</th>"
      "<th>duration, s</th></tr></thead><tbody>";
  for (const auto& [name, sum] : rows) {
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.1f}</td>"
        "<td>{:.1f}</td><td>{:.1f}</td><td>{:.0f}</td><td>{:.1f}</td><td>{:.1f}</td>"
        "<td>{:.0f}</td></tr>",
        telemetry::escaped(name), sum.sessions, sum.refused, sum.stopped, sum.worst_rmse_n,
        sum.worst_overshoot_n, sum.max_over_trip_n, sum.bony_peak_n, to_mm(sum.min_arm_distance_m),
        to_mm(sum.mean_tool_to_acupoint_m), to_mm(sum.max_tool_to_acupoint_m), sum.mean_duration_s);
  }
  return html + "</tbody></table></div>";
}

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

std::string plots_of(const std::vector<SessionOutcome>& outcomes) {
  std::vector<double> rmse_n, over_n, apart_mm, off_mm;
  for (const SessionOutcome& one : outcomes) {
    if (!one.refused.empty()) continue;
    rmse_n.push_back(one.rmse_n);
    over_n.push_back(one.over_trip_n);
    apart_mm.push_back(to_mm(one.arm_distance_m));
    for (const double off_m : one.tool_to_acupoint_m) off_mm.push_back(to_mm(off_m));
  }
  const std::string plots[] = {
      sorted_plot("force error of the sessions", "force error, N RMS", rmse_n, 1.5),
      sorted_plot("force beyond what the zone bears", "over what the zone bears, N", over_n, 0.0),
      sorted_plot("distance between the arms", "arms apart, mm", apart_mm, 25.0),
      sorted_plot("from the tool to the true acupoint", "tool to acupoint, mm", off_mm, 17.0)};
  std::string html = "<div class=\"even\">";
  for (const std::string& plot : plots) html += "<div>" + plot + "</div>";
  return html + "</div>";
}

}  // namespace

std::string session_page(const std::vector<SessionRow>& rows,
                         const std::vector<SessionRow>& adaptive,
                         const std::vector<SessionOutcome>& outcomes,
                         const std::vector<std::string>& incidents) {
  const SessionSummary& all = rows.back().sum;
  std::string html = fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Whole massages</title><style>{}</style></head>"
      "<body><main><div class=\"over\"><span>tuina evaluate massage</span><span "
      "class=\"badge\">simulation</span></div><h1>Whole massages, judged by what only the "
      "simulation knows</h1><p class=\"lead\">{} sessions from the scan to the last stroke: {} "
      "refused, {} stopped. The true force never came nearer than {:.1f} N to what its place "
      "bears; the arms kept {:.0f} mm apart.</p>",
      telemetry::report_style, all.sessions, all.refused, all.stopped, -all.max_over_trip_n,
      to_mm(all.min_arm_distance_m));
  html +=
      "<section><h2>By programme</h2><p>Forces are true contact forces; zones are drawn from "
      "the true points.</p>" +
      table_of(rows) + "</section>";
  html += "<section><h2>All of them, sorted</h2><p>Dashed: what must be kept.</p>" +
          plots_of(outcomes) + "</section>";
  if (!adaptive.empty()) {
    html +=
        "<section><h2>What steering by the tissue changes</h2><p>The same people and "
        "programmes with it and without.</p>" +
        table_of(adaptive) + "</section>";
  }
  html += "<section><h2>What did not go as planned</h2>";
  if (incidents.empty()) html += "<p class=\"calm\">Nothing.</p>";
  for (const std::string& incident : incidents)
    html += fmt::format("<p class=\"stop\">{}</p>", telemetry::escaped(incident));
  return html + "</section></main></body></html>\n";
}

}  // namespace tuina::app
