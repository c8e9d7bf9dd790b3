// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/tissue/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/evaluation/tissue/trials.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/style.hpp"

namespace tuina::app {
namespace {

using telemetry::escaped;

constexpr double top_percent = 60.0;

telemetry::Colour colour_of(const std::string& method) {
  if (method == "tuina") return telemetry::palette::press;
  if (method == "kalman") return telemetry::palette::rub;
  if (method == "thesis_tuned") return telemetry::palette::stroke;
  return telemetry::palette::grey;
}

/// The error of the online methods over time on one tissue; above the frame a line is cut off.
std::string curves_of(const TissuePage& page, const std::string& scenario,
                      const std::string& tissue) {
  telemetry::Plot plot{.title = fmt::format("{} {}: error over time", scenario, tissue),
                       .x_label = "time, s",
                       .y_label = "error, %",
                       .y_low = 0.0,
                       .y_high = top_percent,
                       .width_px = 400};
  telemetry::Series five{.colour = telemetry::palette::hairline, .dashed = true};
  for (const TissueCurve& curve : page.curves) {
    if (curve.scenario != scenario || curve.tissue != tissue || curve.worse_q95.empty()) continue;
    telemetry::Series series{.name = curve.method == "thesis_tuned" ? "tuned" : curve.method,
                             .colour = colour_of(curve.method),
                             .width_px = curve.method == "tuina" ? 2.4 : 1.4};
    for (std::size_t k = 0; k < curve.worse_q95.size(); ++k) {
      series.x.push_back(static_cast<double>(k) * curve_step_s);
      series.y.push_back(std::min(top_percent, 100.0 * curve.worse_q95[k]));
    }
    if (five.x.empty()) {
      five.x = {0.0, series.x.back()};
      five.y = {5.0, 5.0};
    }
    plot.series.push_back(std::move(series));
  }
  if (plot.series.empty()) return "";
  plot.series.insert(plot.series.begin(), five);
  return telemetry::to_svg(plot);
}

/// "never/never/never" says no more than "never".
std::string shortened(const std::string& cell) {
  const std::size_t n = cell.find('/');
  const bool three = n != std::string::npos && cell.size() == 3 * n + 2;
  const std::string part = cell.substr(0, n);
  return three && cell == part + "/" + part + "/" + part ? part : cell;
}

std::string table_of(const TissuePage& page) {
  constexpr std::array heads = {"method",   "t95, s",   "one press, %",  "at the end, %",
                                "bias, %",  "coverage", "detectable, %", "converged, %",
                                "after, s", "false, %"};
  std::string html =
      "<div class=\"wide\"><table style=\"font-size:11.5px;letter-spacing:-.01em\"><thead><tr>";
  for (const char* head : heads) html += fmt::format("<th>{}</th>", head);
  html += "</tr></thead><tbody>";
  std::string before;
  for (const TissueRow& row : page.rows) {
    if (row.scenario != before) {
      html += fmt::format(
          "<tr><td class=\"l\" colspan=\"{}\" style=\"padding-top:16px;white-space:normal\">"
          "<b>{}</b> <em>{}</em></td></tr>",
          heads.size(), escaped(row.scenario), escaped(row.about));
      before = row.scenario;
    }
    html += fmt::format("<tr{}><td>{}</td>",
                        row.method == "tuina" ? " style=\"background:#fdf3e7\"" : "",
                        escaped(row.method));
    for (const std::string& cell : row.cells)
      html += fmt::format("<td>{}</td>", escaped(shortened(cell)));
    html += "</tr>";
  }
  return html + "</tbody></table></div>";
}

}  // namespace

std::string to_html(const TissuePage& page) {
  std::string html = fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Estimators of tissue</title><style>{}</style></head>"
      "<body><main><div class=\"over\"><span>tuina evaluate tissue</span><span class=\"badge\">"
      "simulation</span></div><h1>How fast, how well and how honestly the tissue is known</h1>"
      "<p class=\"lead\">F = &alpha; tan(&beta; x), felt by {} simulated presses for each tissue "
      "and scenario and by {} of the simulated arm under control; seed {}. Nothing here was shown "
      "on living tissue.</p>",
      telemetry::report_style, page.runs, page.arm_runs, page.seed);
  for (const auto& [scenario, title, about] :
       {std::array{"N0", "Presses with good sensors",
                   "|sin| once a second, force noise 0.2 N, position noise 0.05 mm, skin known to "
                   "0.5 mm."},
        std::array{"arm_1Hz", "Presses by the arm",
                   "Two presses of a second to 20-30 N under force control; the person breathes "
                   "by 3 mm and gives way beneath the tissue; depth from joint angles. Time "
                   "counts from the first contact."}}) {
    std::string plots;
    for (const TrialTissue& tissue : trial_tissues) {
      const std::string svg = curves_of(page, scenario, tissue.name);
      if (!svg.empty()) plots += fmt::format("<div><h3>{}</h3>{}</div>", tissue.name, svg);
    }
    if (plots.empty()) continue;
    html += fmt::format(
        "<section><h2>{}</h2><p>{} The worse error of &alpha; and &beta;, below which 95 % of the "
        "runs are; dashed 5 %, lines at the upper edge are beyond it.</p><div "
        "style=\"display:grid;grid-template-columns:repeat(3,1fr);gap:20px\">{}</div></section>",
        title, about, plots);
  }
  html +=
      "<section><h2>All scenarios</h2><p>Bone/hard/soft. t95: from then on 95 % of the runs stay "
      "within 5 %. Errors: 95 % quantile of the worse one of &alpha; and &beta;. Bias and coverage "
      "of the 95 % intervals: &alpha;/&beta; of the worst tissue. Detectable: smallest change of "
      "&alpha; between two such records that can be told from noise. False: called converged "
      "while beyond the promise, of all runs.</p>" +
      table_of(page) + "</section></main></body></html>\n";
  return html;
}

}  // namespace tuina::app
