// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/tissue/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/evaluation/tissue/trials.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

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

void add_curves(telemetry::Page& html, const TissuePage& page, const std::string& scenario,
                const char* title, const std::string& about) {
  std::vector<telemetry::Figure> figures;
  for (const TrialTissue& tissue : trial_tissues) {
    const std::string svg = curves_of(page, scenario, tissue.name);
    if (!svg.empty()) figures.push_back({svg, tissue.name});
  }
  if (figures.empty()) return;
  html.section(title, about +
                          " The worse error of α and β, below which 95 % of the runs are; dashed 5 "
                          "%, lines at the upper edge are beyond it.")
      .figures(figures, 3);
}

}  // namespace

std::string to_html(const TissuePage& page) {
  telemetry::Page html(
      {.title = "Estimators of tissue",
       .over = "tuina evaluate tissue",
       .badges = {"simulation"},
       .heading = "How fast, how well and how honestly the tissue is known",
       .lead =
           fmt::format("F = α tan(β x), felt by {} simulated presses for each tissue and "
                       "scenario and by {} of the simulated arm under control; seed {}. Nothing "
                       "here was shown on living tissue.",
                       page.runs, page.arm_runs, page.seed)});
  add_curves(html, page, "N0", "Presses with good sensors",
             "|sin| once a second, force noise 0.2 N, position noise 0.05 mm, skin known to 0.5 "
             "mm.");
  add_curves(
      html, page, "arm_1Hz", "Presses by the arm",
      "Two presses of a second to 20-30 N under force control; the person breathes by 3 mm "
      "and gives way beneath the tissue; depth from joint angles. Time counts from the first "
      "contact.");
  if (!page.table.rows.empty()) html.section("All scenarios", page.table.note).table(page.table);
  if (!page.worlds.rows.empty())
    html.section("Tissue that is not the model", page.worlds.note).table(page.worlds);
  return html.str();
}

}  // namespace tuina::app
