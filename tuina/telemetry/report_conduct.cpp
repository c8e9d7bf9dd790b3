// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report_conduct.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/report_figures.hpp"
#include "tuina/telemetry/svg_plot.hpp"

namespace tuina::telemetry {

std::string distance_figure(const ReportData& data) {
  if (data.distances.empty()) return "";
  Series apart{.name = "", .colour = palette::press};
  for (const ArmDistance& row : data.distances) {
    apart.x.push_back(row.time_s);
    apart.y.push_back(to_mm(row.apart_m));
  }
  const double end_s = std::max(data.duration_s, apart.x.back());
  const double stop_mm = to_mm(data.stopping_distance_m);
  Series stop{.name = "they stop",
              .x = {0.0, end_s},
              .y = {stop_mm, stop_mm},
              .colour = palette::stop,
              .dashed = true};
  const double most_mm = *std::max_element(apart.y.begin(), apart.y.end());
  return to_svg(Plot{.title = "Distance between the arms over the session",
                     .x_label = "time, s",
                     .y_label = "arms apart, mm",
                     .series = {std::move(stop), std::move(apart)},
                     .x_low = 0.0,
                     .x_high = end_s,
                     .y_low = 0.0,
                     .y_high = 1.05 * most_mm,
                     .width_px = 1040,
                     .height_px = 200});
}

std::string decisions_section(const ReportData& data) {
  if (data.decisions.empty()) return "";
  std::string html =
      "<section class=long><h2>What the tissue decided</h2><p>While it presses, the robot feels "
      "how "
      "hard and how thick the tissue is, and does less where less is right. Every change, with its "
      "reason; the rules are those of the manual.</p><div class=wide><table><thead><tr><th>time, s"
      "<th class=l>arm<th class=l>path<th class=l>rule<th class=l>reason<th>planned, N<th>"
      "decided, N</thead><tbody>";
  for (const SteeringDecision& made : data.decisions) {
    html += fmt::format(
        "<tr><td>{:.1f}<td class=l>{}<td class=l>{}<td class=l>{}<td class=l "
        "style=\"white-space:normal\">{}<td>{}<td>{:.1f}",
        made.time_s, name_of(made.arm), escaped(made.path), escaped(made.rule),
        escaped(made.reason), made.from_n > 0.0 ? fmt::format("{:.1f}", made.from_n) : "",
        made.to_n);
  }
  return html + "</tbody></table></div></section>";
}

}  // namespace tuina::telemetry
