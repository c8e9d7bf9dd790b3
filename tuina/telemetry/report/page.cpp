// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_parts.hpp"
#include "tuina/telemetry/report/conduct.hpp"
#include "tuina/telemetry/report/figures.hpp"
#include "tuina/telemetry/report/tissue.hpp"

namespace tuina::telemetry {
namespace {

std::string minutes(double seconds) {
  const auto whole = static_cast<long>(std::lround(std::max(0.0, seconds)));
  if (whole < 60) return fmt::format("{} seconds", whole);
  return fmt::format("{} min {} s", whole / 60, whole % 60);
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (k > 0) text += k + 1 == words.size() ? " and " : ", ";
    text += words[k];
  }
  return text;
}

std::string in_words(std::size_t count) {
  constexpr std::array<const char*, 13> words = {"no",   "one",    "two",   "three", "four",
                                                 "five", "six",    "seven", "eight", "nine",
                                                 "ten",  "eleven", "twelve"};
  return count < words.size() ? words[count] : fmt::format("{}", count);
}

/// Over the seven points of the thesis, as session.json counts it; over all if none of those is
/// there.
struct MeanError {
  double mean_m = 0.0;
  std::size_t points = 0;
};

std::optional<MeanError> mean_error(const ReportData& data) {
  MeanError seven;
  MeanError all;
  for (const FoundAcupoint& found : data.acupoints) {
    if (!found.error_m) continue;
    const bool one_of_seven = std::find(seven_acupoints.begin(), seven_acupoints.end(),
                                        found.acupoint.name) != seven_acupoints.end();
    for (MeanError* mean : {&seven, &all}) {
      if (mean == &seven && !one_of_seven) continue;
      mean->mean_m += *found.error_m;
      ++mean->points;
    }
  }
  MeanError& chosen = seven.points > 0 ? seven : all;
  if (chosen.points == 0) return std::nullopt;
  chosen.mean_m /= static_cast<double>(chosen.points);
  return chosen;
}

double peak_force_n(const ReportData& data) {
  double peak = 0.0;
  for (const TraceRow& row : data.trace)
    peak = std::max(peak, data.simulated ? row.true_force_n : row.measured_force_n);
  return peak;
}

/// What happened, for somebody who treats people and has no use for a plot.
std::string summary(const ReportData& data) {
  std::string text;
  text += fmt::format(
      "{} {} for a massage of {}. ", data.simulated ? "A simulated person" : "A person",
      data.position == BodyPosture::sitting ? "sat" : "lay face down", minutes(data.duration_s));
  if (!data.acupoints.empty()) {
    double widest = 0.0;
    for (const FoundAcupoint& found : data.acupoints)
      widest = std::max(widest, found.acupoint.uncertainty_m);
    text += fmt::format(
        "A laser scan of the back gave the places of {} acupoints, each known to "
        "within {:.0f} mm",
        in_words(data.acupoints.size()), std::ceil(to_mm(widest)));
    if (const auto error = mean_error(data)) {
      text += fmt::format(
          "; {} were {:.0f} mm from their true places on average",
          error->points == data.acupoints.size() ? "they" : "the main " + in_words(error->points),
          to_mm(error->mean_m));
    }
    text += ". ";
  }
  std::vector<std::string> done;
  for (const Technique technique : all_techniques) {
    std::set<std::string> places;
    std::size_t count = 0;
    for (const PerformedPath& performed : data.paths) {
      if (performed.path.technique != technique) continue;
      ++count;
      places.insert(performed.path.acupoints.begin(), performed.path.acupoints.end());
    }
    if (count == 0) continue;
    const std::size_t served = places.empty() ? count : places.size();
    done.push_back(fmt::format("{} {} {}", row_of(technique).did, in_words(served),
                               served == 1 ? "point" : "points"));
  }
  if (!done.empty()) text += fmt::format("Two arms {}. ", listed(done));
  if (!data.trace.empty())
    text += fmt::format("The firmest touch was {:.0f} N, the weight of {:.1f} kg. ",
                        peak_force_n(data), peak_force_n(data) / gravity_m_per_s2);
  const FeltTissue* softest = nullptr;
  const FeltTissue* hardest = nullptr;
  for (const FeltTissue& felt : data.tissue) {
    if (!felt.estimate.converged) continue;
    const double stiffness = felt.stiffness_n_per_mm;
    if (softest == nullptr || stiffness < softest->stiffness_n_per_mm) softest = &felt;
    if (hardest == nullptr || stiffness > hardest->stiffness_n_per_mm) hardest = &felt;
  }
  if (softest != hardest)
    text += fmt::format("The tissue felt hardest at {} and softest at {}. ",
                        figures::spoken(hardest->name), figures::spoken(softest->name));
  text += given_in_words(data);
  if (data.stops.empty())
    text += "Nothing had to be stopped.";
  else
    text += fmt::format("The session was stopped for safety after {}: {}.",
                        minutes(data.stops.front().time_s), data.stops.front().cause.words);
  return text;
}

std::vector<KeyNumber> tiles(const ReportData& data) {
  const long whole = std::lround(std::max(0.0, data.duration_s));
  std::vector<KeyNumber> tiles = {{"Massage", fmt::format("{}:{:02}", whole / 60, whole % 60),
                                   "min", fmt::format("{} paths of two arms", data.paths.size())}};
  if (!data.acupoints.empty()) {
    const auto error = mean_error(data);
    tiles.push_back(
        error ? KeyNumber{"Acupoints", fmt::format("{:.1f}", to_mm(error->mean_m)), "mm",
                          fmt::format("mean distance of {} to the truth", error->points)}
              : KeyNumber{"Acupoints", fmt::format("{}", data.acupoints.size()), "", "found"});
  }
  if (!data.trace.empty())
    tiles.push_back({"Peak force", fmt::format("{:.1f}", peak_force_n(data)), "N",
                     data.simulated ? "true force, whole session" : "measured, whole session"});
  for (const TechniqueForce& force : data.forces) {
    if (force.technique == Technique::press)
      tiles.push_back({"Force error", fmt::format("{:.2f}", force.rmse_n), "N",
                       "root mean square while pressing"});
  }
  for (const KeyNumber& number : data.numbers) {
    tiles.push_back(number);
    tiles.back().label = figures::capital(number.label);
  }
  tiles.push_back({"Stops", fmt::format("{}", data.stops.size()), "",
                   data.stops.empty() ? "the guard never stepped in" : "see below"});
  return tiles;
}

Table acupoint_table(const ReportData& data) {
  const bool truth = std::any_of(data.acupoints.begin(), data.acupoints.end(),
                                 [](const FoundAcupoint& f) { return f.error_m.has_value(); });
  Table table{
      .columns = {{.head = "Point"},
                  {.head = "within, mm", .digits = 1},
                  {.head = truth ? "distance to the truth, mm" : "", .digits = 1, .truth = true}}};
  for (const FoundAcupoint& found : data.acupoints) {
    const Acupoint& point = found.acupoint;
    table.add({{figures::spoken(point.name), figures::chinese_name(point.name)},
               to_mm(point.uncertainty_m),
               found.error_m ? Cell(to_mm(*found.error_m)) : Cell()});
  }
  return table;
}

void add_back(Page& page, const ReportData& data) {
  const std::string figure = figures::back(data);
  Part picture, points;
  if (figure.empty()) {
    picture.note("There is no scan to show.");
  } else {
    picture.html(figure).key(technique_key(data));
  }
  if (data.acupoints.empty()) {
    points.note("No acupoint was located.");
  } else {
    points.table(acupoint_table(data))
        .note(
            std::string("The pale ring around a point, and the column “within”, is the radius that "
                        "holds the true point in 95 of 100 cases. Left and right are the person’s "
                        "own.") +
            (mean_error(data) ? " The last column compares with the simulated person’s true "
                                "points, which only a simulation knows."
                              : ""));
  }
  page.section("The back",
               "The surface that the scanner saw, with the acupoints that were found on it and the "
               "paths of both arms.",
               false)
      .beside(picture, points);
}

void add_forces(Page& page, const ReportData& data) {
  Part& part = page.section(
      "The force on the skin",
      "What was asked for, what the person truly felt, and what the sensor at the wrist said. "
      "Contacts stand one behind the other; the travel between them is left out.");
  bool any = false;
  for (const Technique technique : all_techniques) {
    const std::string figure = figures::force(data, technique);
    if (figure.empty()) continue;
    any = true;
    part.heading(figures::capital(row_of(technique).doing), colour_of(technique));
    for (const TechniqueForce& force : data.forces) {
      if (force.technique == technique)
        part.note(fmt::format("Root mean square error {:.2f} N, peak {:.1f} N (true force{}).",
                              force.rmse_n, force.peak_n,
                              data.simulated ? ", known only in simulation" : ""));
    }
    part.figure(figure);
  }
  const std::string close_up = figures::first_press_force(data);
  if (!close_up.empty())
    part.heading("The first press, close up")
        .figures({{.svg = close_up}, {.svg = figures::first_press_depth(data)}});
  if (!any) part.note("There is no record of forces.");
}

void add_stops(Page& page, const ReportData& data) {
  Part& part = page.section("Stops", "", false);
  if (data.stops.empty())
    part.calm("The guard watched every millisecond and had no cause to stop.");
  for (const Stop& stop : data.stops)
    part.alarm(fmt::format("{:.3f} s: {}", stop.time_s, stop.cause.words));
  std::vector<std::string> troubles;
  for (const PerformedPath& performed : data.paths) {
    if (!performed.contact_fault.empty())
      troubles.push_back(fmt::format("{} arm, {}: {}", name_of(performed.arm), performed.path.name,
                                     performed.contact_fault));
  }
  if (!troubles.empty()) part.heading("Not carried out as planned").list(troubles);
  if (!data.plan_notes.empty())
    part.heading("Planned otherwise than ordered").list(data.plan_notes);
}

PageHead head_of(const ReportData& data) {
  PageHead head{
      .title = fmt::format("Massage of {}, {} · tuina", data.person, name_of(data.position)),
      .over = "tuina massage report",
      .heading = data.person + ", " + name_of(data.position),
      .lead = summary(data)};
  if (data.simulated) head.badges.emplace_back("simulation");
  if (!data.stops.empty()) head.alarms.emplace_back("stopped");
  if (!data.programme.empty()) head.meta += "programme " + data.programme + "  ·  ";
  if (!data.version.empty()) head.meta += "tuina " + data.version + "  ·  ";
  head.meta += fmt::format("seed {}", data.seed);
  if (data.simulated)
    head.footer =
        "No person and no robot took part: everything on this page happened in a simulation. ";
  head.footer +=
      "tuina is open research software. It is not a medical device and makes no diagnosis.";
  return head;
}

}  // namespace

std::string report_page(const ReportData& data) {
  Page page(head_of(data));
  page.opening().tiles(tiles(data));
  add_back(page, data);
  add_conduct(page, data);
  add_given(page, data);
  add_forces(page, data);
  add_tissue(page, data);
  add_decisions(page, data);
  add_stops(page, data);
  if (!data.config_toml.empty()) {
    page.section("Configuration")
        .folded("Every setting of this session",
                Part().html("<pre>" + escaped(data.config_toml) + "</pre>"));
  }
  return page.str();
}

std::string back_picture(const ReportData& data) {
  return figures::back(data);
}

}  // namespace tuina::telemetry
