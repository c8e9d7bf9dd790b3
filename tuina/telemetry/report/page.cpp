// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_parts.hpp"
#include "tuina/telemetry/report/conduct.hpp"
#include "tuina/telemetry/report/figures.hpp"
#include "tuina/telemetry/report/summary.hpp"
#include "tuina/telemetry/report/tissue.hpp"

namespace tuina::telemetry {
namespace {

std::vector<KeyNumber> tiles(const ReportData& data) {
  const Language& say = data.language;
  const long whole = std::lround(std::max(0.0, data.duration_s));
  std::vector<KeyNumber> tiles = {{say("Massage"), fmt::format("{}:{:02}", whole / 60, whole % 60),
                                   "min", say("paths of both arms: {}", data.paths.size())}};
  if (!data.acupoints.empty()) {
    const auto error = mean_error(data);
    tiles.push_back(error ? KeyNumber{say("Acupoints"), fmt::format("{:.1f}", to_mm(error->mean_m)),
                                      "mm", say("mean distance of {} to the truth", error->points)}
                          : KeyNumber{say("Acupoints"), fmt::format("{}", data.acupoints.size()),
                                      "", say("found")});
  }
  if (!data.trace.empty())
    tiles.push_back(
        {say("Peak force"), fmt::format("{:.1f}", peak_force_n(data)), "N",
         data.simulated ? say("true force, whole session") : say("measured, whole session")});
  if (data.force_rmse_n > 0.0)
    tiles.push_back({say("Force error"), fmt::format("{:.2f}", data.force_rmse_n), "N",
                     say("root mean square over all contacts")});
  for (const KeyNumber& number : data.numbers) {
    tiles.push_back(
        {figures::capital(say(number.label)), number.value, say(number.unit), say(number.remark)});
  }
  tiles.push_back({say("Stops"), fmt::format("{}", data.stops.size()), "",
                   data.stops.empty() ? say("the guard never stopped an arm") : say("see below")});
  return tiles;
}

bool is_worked_on(const ReportData& data, const std::string& acupoint) {
  return std::any_of(data.paths.begin(), data.paths.end(), [&](const PerformedPath& performed) {
    const std::vector<std::string>& names = performed.path.acupoints;
    return std::find(names.begin(), names.end(), acupoint) != names.end();
  });
}

/// Those that paths of the session name, or the others.
Table acupoint_table(const ReportData& data, bool worked_on) {
  const bool truth = std::any_of(data.acupoints.begin(), data.acupoints.end(),
                                 [](const FoundAcupoint& f) { return f.error_m.has_value(); });
  const Language& say = data.language;
  Table table{
      .columns = {
          {.head = say("Point")},
          {.head = say("within, mm"), .digits = 1},
          {.head = truth ? say("distance to the truth, mm") : "", .digits = 1, .truth = true}}};
  for (const FoundAcupoint& found : data.acupoints) {
    const Acupoint& point = found.acupoint;
    if (is_worked_on(data, point.name) != worked_on) continue;
    table.add({{figures::spoken(point.name, say), say(figures::chinese_name(point.name))},
               to_mm(point.uncertainty_m),
               found.error_m ? Cell(to_mm(*found.error_m)) : Cell()});
  }
  return table;
}

void add_back(Page& page, const ReportData& data, const std::string& figure) {
  const Language& say = data.language;
  Part picture, points;
  if (figure.empty()) {
    picture.note(say("There is no scan to show."));
  } else {
    picture.html(figure).key(technique_key(data));
  }
  if (data.acupoints.empty()) {
    points.note(say("No acupoint was located."));
  } else {
    const Table worked_on = acupoint_table(data, true);
    (worked_on.rows.empty() ? points : points.table(worked_on))
        .note(say("The pale ring around a point, and the column “within”, is the radius that "
                  "holds the true point in 95 of 100 cases. Left and right are the person’s "
                  "own.") +
              (mean_error(data) ? say(" The last column compares with the simulated person’s true "
                                      "points, which only a simulation knows.")
                                : ""));
  }
  Part& part =
      page.section(say("The back"),
                   say("The surface that the scanner saw, with the acupoints that were found on it "
                       "and the paths of both arms."),
                   false)
          .beside(picture, points);
  const Table others = acupoint_table(data, false);
  if (!others.rows.empty()) part.heading(say("Found as well")).columns(others, 3);
}

void add_forces(Page& page, const ReportData& data) {
  const Language& say = data.language;
  Part& part = page.section(
      say("The force on the skin"),
      data.simulated
          ? say("What was asked for, what the person truly felt, and what the sensor at the wrist "
                "said. Contacts stand one behind the other; the travel between them is left out.")
          : say("What was asked for, and what the sensor at the wrist said. Contacts stand one "
                "behind the other; the travel between them is left out."));
  bool any = false;
  for (const Technique technique : all_techniques) {
    const std::string figure = figures::force(data, technique);
    if (figure.empty()) continue;
    any = true;
    part.heading(figures::capital(say(row_of(technique).doing)), colour_of(technique));
    for (const TechniqueForce& force : data.forces) {
      if (force.technique != technique) continue;
      part.note(say("Root mean square error {:.2f} N, peak {:.1f} N", force.rmse_n, force.peak_n) +
                (data.simulated ? say(" (true force, known only in simulation).")
                                : say(" (as measured).")));
    }
    part.figure(figure);
  }
  const std::string close_up = figures::first_press_force(data);
  if (!close_up.empty()) {
    std::vector<Figure> pair = {{.svg = close_up}};
    // How deep the skin was pressed in is known only in simulation.
    if (data.simulated) pair.push_back({.svg = figures::first_press_depth(data)});
    part.heading(say("The first press, close up")).figures(pair);
  }
  if (!any) part.note(say("There is no record of forces."));
}

void add_stops(Page& page, const ReportData& data) {
  const Language& say = data.language;
  Part& part = page.section(say("Stops"), "", false);
  if (data.stops.empty())
    part.calm(say("The guard watched every millisecond and had no cause to stop."));
  for (const Stop& stop : data.stops) part.alarm(say("{:.3f} s: {}", stop.time_s, say(stop.cause)));
  std::vector<std::string> troubles;
  for (const PerformedPath& performed : data.paths) {
    if (!performed.contact_fault.empty())
      troubles.push_back(say("{} arm, {}: {}", name_of(performed.arm), performed.path.name,
                             performed.contact_fault));
  }
  if (!troubles.empty()) part.heading(say("Not carried out as planned")).list(troubles);
  if (!data.plan_notes.empty())
    part.heading(say("Planned otherwise than ordered")).list(say(data.plan_notes));
}

PageHead head_of(const ReportData& data) {
  const Language& say = data.language;
  PageHead head{.title = say("Massage of {}, {} · tuina", data.person, name_of(data.position)),
                .language = say.tag(),
                .over = say("tuina massage report"),
                .heading = say("A massage, {}", name_of(data.position)),
                .lead = summary(data)};
  if (data.simulated) head.badges.push_back(say("simulation"));
  if (!data.stops.empty()) head.alarms.push_back(say("stopped"));
  if (!data.person.empty()) head.meta += say("person {}", data.person) + "  ·  ";
  if (!data.programme.empty()) head.meta += say("programme {}", data.programme) + "  ·  ";
  if (!data.version.empty()) head.meta += "tuina " + data.version + (data.simulated ? "  ·  " : "");
  if (data.simulated) {
    head.meta += say("seed {}", data.seed);
    head.footer =
        say("No person and no robot took part: everything on this page happened in a simulation. ");
  }
  head.footer +=
      say("tuina is open research software. It is not a medical device and makes no diagnosis.");
  return head;
}

}  // namespace

std::string report_page(const ReportData& data, std::string* back_svg) {
  Page page(head_of(data));
  page.opening().tiles(tiles(data));
  figures::BackFigure back = figures::back(data, technique_key(data));
  add_back(page, data, back.plain);
  if (back_svg != nullptr) *back_svg = std::move(back.with_key);
  add_conduct(page, data);
  add_given(page, data);
  add_forces(page, data);
  add_tissue(page, data);
  add_decisions(page, data);
  add_stops(page, data);
  if (!data.config_toml.empty()) {
    page.section(data.language("Configuration"))
        .folded(data.language("Every setting of this session"),
                Part().html("<pre>" + escaped(data.config_toml) + "</pre>"));
  }
  return page.str();
}

std::string back_picture(const ReportData& data) {
  return figures::back(data, technique_key(data)).with_key;
}

}  // namespace tuina::telemetry
