// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/evaluation/control/report.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/heat_map.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/style.hpp"

namespace tuina::app {
namespace {

using telemetry::escaped;
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

std::string html_table(const ControlTable& table) {
  std::string html = "<div class=\"wide\"><table><tr>";
  for (const auto& [name, value] : table.rows.front().labels)
    html += fmt::format("<th class=\"l\">{}</th>", escaped(name == "what" ? "" : name));
  html +=
      "<th>error, N rms</th><th>over target, N</th><th>ripple, N</th><th>highest, N</th><th>tool, "
      "mm/s</th><th>second contact, N</th><th>stopped</th><th></th></tr>\n";
  for (const ControlRow& row : table.rows) {
    html += "<tr>";
    for (const auto& [name, value] : row.labels)
      html += fmt::format("<td class=\"l\">{}</td>", escaped(value));
    const ControlResult& r = row.result;
    html += fmt::format(
        "<td>{:.2f}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.1f}</td><td>{:.0f}</td><td>{:.1f}</td>"
        "<td>{} of {}</td><td>{}</td></tr>\n",
        r.rmse_n, r.overshoot_n, r.ripple_n, r.highest_n, to_mm(r.max_speed_m_per_s),
        r.second_impact_n, r.stopped, r.runs,
        !row.target              ? ""
        : row.target->reached(r) ? "reached"
                                 : "<b>not reached</b>");
  }
  return html + "</table></div>\n";
}

std::string section(const std::string& title, const std::string& text, const std::string& body) {
  return fmt::format("<section class=\"long\"><h2>{}</h2><p>{}</p>{}</section>\n", escaped(title),
                     escaped(text), body);
}

std::string wide(const std::string& svg) {
  return "<div class=\"wide\">" + svg + "</div>";
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
  if (const auto* table = report.table("stability")) {
    figures.emplace_back("control_stability",
                         stability_maps(*table, "tuina", "damping_share", "damping, share of it"));
    figures.emplace_back("control_stability_thesis",
                         stability_maps(*table, "thesis", "mass_kg", "M_e, kg"));
  }
  return figures;
}

std::string page_of(const ControlReport& report) {
  const auto figures = figures_of(report);
  const auto figure = [&](const std::string& name) {
    for (const auto& [key, svg] : figures)
      if (key == name) return wide(svg);
    return std::string();
  };
  std::string body;
  const auto add = [&](const char* name, const char* title, const std::string& figure_html,
                       const std::string& more = "") {
    const ControlTable* table = report.table(name);
    if (table == nullptr) return;
    const bool many = table->name == "controllers";
    body +=
        section(title, table->about + more,
                figure_html + html_table(many ? grouped(*table, {"controller", "torso", "force_n"})
                                              : *table));
  };
  add("targets", "Targets", "");
  body += section("One press by five controllers",
                  "30 N on soft muscle over a rigid torso; the tissue is believed 30 % wrong. The "
                  "laws of the thesis and the one without trim have no force loop.",
                  figure("control_press"));
  add("controllers", "Controllers", figure("control_errors"),
      " A run that lost contact and was stopped counts with the force it did not give.");
  body +=
      section("A person rises",
              "30 mm at 0.1 m/s under 40 N on hard muscle, from 2.5 s on; tuina is startled and "
              "lets go.",
              figure("control_rise"));
  add("events", "What a person may do", "");
  add("curved_back", "Curved back", "");
  add("taps", "Taps", "");
  if (const ControlTable* table = report.table("stability")) {
    body +=
        section("Where contact trembles",
                table->about + " The number is the ripple in newtons; `stop`: the guard ended it.",
                "<h3>tuina</h3>" + figure("control_stability") + "<h3>[thesis] (3.5)</h3>" +
                    figure("control_stability_thesis"));
  }
  add("stiffness", "Stiffness", figure("control_stiffness"));
  add("devices", "Sensors and drives", "");
  std::string pulls =
      "<table><tr><th class=\"l\">law</th><th>torque, Nm</th><th>joint, "
      "rad/s</th><th></th></tr>";
  for (const BeyondReach& pull : report.beyond_reach) {
    pulls +=
        fmt::format("<tr><td class=\"l\">{}</td><td>{:.3g}</td><td>{:.3g}</td><td>{}</td></tr>",
                    escaped(pull.law), pull.max_torque_nm, pull.max_speed_rad_per_s,
                    pull.survived ? "" : "diverges");
  }
  body += section("Beyond reach", "The target walks 0.2 m beyond the stretched arm.",
                  pulls + "</table>");
  std::string bounds =
      "<table><tr><th class=\"l\">tissue</th><th>held, N</th><th>answer after, ms</th><th>push, "
      "N</th><th>highest force, N</th></tr>";
  for (const ReflexBound& bound : report.reflex_bounds) {
    bounds += fmt::format(
        "<tr><td "
        "class=\"l\">{}</td><td>{:.0f}</td><td>{:.1f}</td><td>{:.0f}</td><td>{:.0f}</td></tr>",
        bound.tissue, bound.force_n, bound.after_ms, bound.push_n, bound.highest_n);
  }
  body += section("What no reflex can do better",
                  "A person on a rigid torso rises at 0.1 m/s; the arm pushes itself away after a "
                  "time, at once and with nothing in its way.",
                  bounds + "</table>");
  body += section(
      "The thesis' 140 N",
      fmt::format("On a seated person's back the drives hold {:.0f} N at the weakest of {} places "
                  "and {:.0f} N in the median, their torques being an assumption of "
                  "docs/robot.md. The stretched arm reaches {:.2f} m.",
                  report.force_at_tool.min_n, report.force_at_tool.reached,
                  report.force_at_tool.median_n, report.force_at_tool.reach_m),
      "");
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>tuina: control</title>\n"
      "<style>{}</style></head><body><main>\n<p class=\"over\"><span>evaluate control</span><span "
      "class=\"badge\">simulation</span></p><h1>Robot in contact</h1>\n<p class=\"lead\">Every "
      "number is the worst of its runs, and every error is of the true contact force. Nothing here "
      "was tried on a real arm or on people.</p>\n{}<footer>seed {}, {} form</footer>\n"
      "</main></body></html>\n",
      telemetry::report_style, body, report.seed, report.full ? "full" : "quick");
}

}  // namespace tuina::app
