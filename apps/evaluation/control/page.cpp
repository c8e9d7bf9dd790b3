// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/evaluation/control/report.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/heat_map.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

using telemetry::Plot;
using telemetry::Series;
namespace palette = telemetry::palette;

telemetry::Colour colour_of(const std::string& controller) {
  if (controller == "tuina") return palette::press;
  if (controller == "joint") return palette::grey;
  if (controller == "without trim") return palette::stroke;
  return controller == "thesis M_e 1 kg" ? palette::tap : palette::rub;
}

std::string trace_plot(const std::vector<ControlTrace>& traces, const char* title, double begin_s,
                       double end_s) {
  Plot plot{.title = title, .x_label = "time since the press began, s", .y_label = "true force, N"};
  Series target{.name = "target", .colour = palette::ink, .width_px = 1.2, .dashed = true};
  for (const ControlTrace& trace : traces) {
    Series series{.name = trace.controller, .colour = colour_of(trace.controller)};
    const auto first = std::find_if(trace.samples.begin(), trace.samples.end(),
                                    [](const ContactSample& s) { return s.target_n > 0.0; });
    for (auto sample = first; sample != trace.samples.end(); ++sample) {
      const double time_s = sample->time_s - first->time_s;
      if (time_s < begin_s || time_s > end_s) continue;
      series.x.push_back(time_s);
      series.y.push_back(sample->true_force_n);
      if (&trace != &traces.back() || sample->target_n <= 0.0) continue;
      target.x.push_back(time_s);
      target.y.push_back(sample->target_n);
    }
    plot.series.push_back(std::move(series));
  }
  plot.series.push_back(std::move(target));
  plot.y_low = 0.0;
  plot.height_px = 320;
  return telemetry::to_svg(plot);
}

/// One result over a label that is a number, from the rows whose label `key` says `wanted`.
Series over(const ControlTable& table, const char* number, double ControlResult::*value,
            const char* key, const std::string& wanted) {
  Series series;
  for (const ControlRow& row : table.rows) {
    if (row.label(key) != wanted) continue;
    series.x.push_back(std::stod(row.label(number)));
    series.y.push_back(row.result.*value);
  }
  return series;
}

std::string error_plot(const ControlTable& controllers) {
  Plot plot{.title = "error of each controller by force",
            .x_label = "target, N",
            .y_label = "worst error of the true force, N rms"};
  const ControlTable groups = grouped(controllers, {"controller", "force_n"});
  for (const ControllerChoice& choice : controller_choices()) {
    Series series = over(groups, "force_n", &ControlResult::rmse_n, "controller", choice.name);
    series.name = choice.name;
    series.colour = colour_of(choice.name);
    plot.series.push_back(std::move(series));
  }
  plot.y_low = 0.0;
  plot.height_px = 300;
  return telemetry::to_svg(plot);
}

std::string stiffness_plot(const ControlTable& stiffness) {
  Plot plot{.title = "what the spring along the normal means",
            .x_label = "stiffness, N/m",
            .y_label = "N"};
  struct Line {
    const char *what, *name;
    double ControlResult::*value;
    telemetry::Colour colour;
    bool dashed;
  };
  const Line lines[] = {
      {"press, tuina", "error, tuina", &ControlResult::rmse_n, palette::press, false},
      {"press, without trim", "error without trim", &ControlResult::rmse_n, palette::stroke, false},
      {"rises, without trim", "excess when a person rises, without trim",
       &ControlResult::overshoot_n, palette::rub, true}};
  for (const Line& line : lines) {
    Series series = over(stiffness, "stiffness_n_per_m", line.value, "what", line.what);
    series.name = line.name;
    series.colour = line.colour;
    series.dashed = line.dashed;
    plot.series.push_back(std::move(series));
  }
  plot.y_low = 0.0;
  return telemetry::to_svg(plot);
}

struct PositionSection {
  const char *table, *title, *drawing;
};
constexpr PositionSection position_sections[] = {
    {"position", "Arms that take places", ""},
    {"position_targets", "Targets of arms that take places", ""},
    {"position_hold", "The force that they hold", "control_position"},
    {"position_faults", "Wrist sensors that fail", ""}};

/// What an arm that takes places is off by, by how quick it is.
std::string position_plot(const ControlTable& hold) {
  Plot plot{.title = "error of a press of 30 N by arms that take places",
            .x_label = "bandwidth of the arm, Hz",
            .y_label = "worst error of the true force, N rms"};
  ControlTable presses = grouped(hold, {"cycle_hz", "bandwidth_hz", "force_n"});
  std::erase_if(presses.rows, [](const ControlRow& row) { return row.label("force_n") != "30"; });
  for (const char* cycle : {"125", "500"}) {
    Series series = over(presses, "bandwidth_hz", &ControlResult::rmse_n, "cycle_hz", cycle);
    series.name = fmt::format("cycle of {} Hz", cycle);
    series.colour = cycle == std::string("500") ? palette::press : palette::stroke;
    plot.series.push_back(std::move(series));
  }
  plot.series.push_back({.name = "target",
                         .x = {5.0, 40.0},
                         .y = {0.8, 0.8},
                         .colour = palette::grey,
                         .dashed = true});
  plot.y_low = 0.0;
  return telemetry::to_svg(plot);
}

void put_in(std::vector<std::string>& ticks, const std::string& tick) {
  if (std::find(ticks.begin(), ticks.end(), tick) == ticks.end()) ticks.push_back(tick);
}

std::string stability_maps(const ControlTable& stability, const std::string& law,
                           const std::string& y_name, const char* y_label) {
  std::vector<telemetry::HeatMap> maps;
  std::vector<std::string> delays;
  for (const ControlRow& row : stability.rows) put_in(delays, row.label("late_ms"));
  for (const std::string& late : delays) {
    telemetry::HeatMap map{.title = fmt::format("torques {} ms late", late),
                           .x_label = "stiffness, N/m",
                           .y_label = y_label};
    std::vector<const ControlRow*> rows;
    for (const ControlRow& row : stability.rows) {
      if (row.label("law") != law || row.label("late_ms") != late) continue;
      rows.push_back(&row);
      put_in(map.x_ticks, row.label("stiffness_n_per_m"));
      put_in(map.y_ticks, row.label(y_name));
    }
    for (const std::string& y : map.y_ticks) {
      for (const std::string& x : map.x_ticks) {
        const auto found = std::find_if(rows.begin(), rows.end(), [&](const ControlRow* row) {
          return row->label("stiffness_n_per_m") == x && row->label(y_name) == y;
        });
        const ControlResult& result = (*found)->result;
        map.values.push_back(result.stopped > 0 ? std::numeric_limits<double>::infinity()
                                                : result.ripple_n);
      }
    }
    maps.push_back(std::move(map));
  }
  return telemetry::to_svg(maps);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> figures_of(const ControlReport& report) {
  std::vector<std::pair<std::string, std::string>> figures = {
      {"control_press", trace_plot(report.presses, "one press by every controller", 0.0, 5.0)},
      {"control_rise", trace_plot(report.rises, "a person rises", 2.2, 3.2)}};
  if (const auto* table = report.table("controllers"))
    figures.emplace_back("control_errors", error_plot(*table));
  if (const auto* table = report.table("stiffness"))
    figures.emplace_back("control_stiffness", stiffness_plot(*table));
  if (const auto* table = report.table("position_hold"))
    figures.emplace_back("control_position", position_plot(*table));
  if (const auto* table = report.table("stability")) {
    figures.emplace_back("control_stability",
                         stability_maps(*table, "tuina", "damping_share", "damping, share of it"));
    figures.emplace_back("control_stability_thesis",
                         stability_maps(*table, "thesis", "mass_kg", "M_e, kg"));
  }
  return figures;
}

std::string page_of(const ControlReport& report) {
  telemetry::Page page(
      {.title = "tuina: control",
       .over = "tuina evaluate control",
       .badges = {"simulation"},
       .heading = "Robot in contact",
       .lead = "Every number is the worst of its runs, and every error is of the true contact "
               "force. Nothing here was tried on a real arm or on people.",
       .footer = fmt::format("seed {}, {} form", report.seed, report.full ? "full" : "quick")});
  const auto figures = figures_of(report);
  const auto figure = [&](const std::string& name) {
    for (const auto& [key, svg] : figures)
      if (key == name) return svg;
    return std::string();
  };
  const auto add = [&](const char* name, const char* title, const char* drawing = "",
                       const char* more = "") {
    const ControlTable* table = report.table(name);
    if (table == nullptr) return;
    page.section(title, table->about + more).figure(figure(drawing)).table(shown_table(*table));
  };
  add("targets", "Targets");
  page.section(
          "One press by five controllers",
          "30 N on soft muscle over a rigid torso; the tissue is believed 30 % wrong. The laws "
          "of the thesis and the one without trim have no force loop.")
      .figure(figure("control_press"));
  add("controllers", "Controllers", "control_errors",
      " A run that lost contact and was stopped counts with the force it did not give.");
  page.section("A person rises",
               "30 mm at 0.1 m/s under 40 N on hard muscle, from 2.5 s on; tuina is startled and "
               "lets go.")
      .figure(figure("control_rise"));
  add("events", "What a person may do");
  add("curved_back", "Curved back");
  add("taps", "Taps");
  if (const ControlTable* table = report.table("stability")) {
    page.section("Where contact trembles",
                 table->about + " The number is the ripple in newtons; `stop`: the guard ended it.")
        .heading("tuina")
        .figure(figure("control_stability"))
        .heading("[thesis] (3.5)")
        .figure(figure("control_stability_thesis"));
  }
  add("stiffness", "Stiffness", "control_stiffness");
  add("devices", "Sensors and drives");
  add("rules", "Rules of the tissue");
  for (const auto& [name, title, drawing] : position_sections) add(name, title, drawing);
  page.section("Beyond reach", "The target walks 0.2 m beyond the stretched arm.")
      .table(beyond_reach_table(report));
  page.section(
          "What no reflex can do better",
          "A person on a rigid torso rises at 0.1 m/s; the arm pushes itself away after a time, "
          "at once and with nothing in its way.")
      .table(reflex_table(report));
  page.section("The thesis' 140 N", force_sentence(report.force_at_tool) +
                                        " The torques of the drives are an assumption of "
                                        "docs/robot.md.");
  return page.str();
}

}  // namespace tuina::app
