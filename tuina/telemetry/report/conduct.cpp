// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/conduct.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/session_strip.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry {
namespace {

/// One of the distances, in mm over time where it is known; and its smallest value.
struct Distance {
  Series series;
  double min_mm = std::numeric_limits<double>::infinity();
};
std::vector<Distance> distances_of(const ReportData& data) {
  const std::tuple<const char*, double ArmDistance::*, Colour> wanted[] = {
      {"arm to the robot's body", &ArmDistance::to_body_m, palette::tap},
      {"arm to couch", &ArmDistance::to_couch_m, palette::stroke},
      {"arm to person", &ArmDistance::to_person_m, palette::rub},
      {"arm to arm", &ArmDistance::apart_m, palette::press}};
  std::vector<Distance> known;
  for (const auto& [name, member, colour] : wanted) {
    Distance distance{.series = {.name = data.language(name), .colour = colour}};
    for (const ArmDistance& row : data.distances) {
      if (!std::isfinite(row.*member)) continue;
      distance.series.x.push_back(row.time_s);
      distance.series.y.push_back(to_mm(row.*member));
      distance.min_mm = std::min(distance.min_mm, distance.series.y.back());
    }
    if (!distance.series.x.empty()) known.push_back(std::move(distance));
  }
  return known;
}

void add_distances(Part& part, const ReportData& data) {
  const Language& say = data.language;
  const std::vector<Distance> distances = distances_of(data);
  if (distances.empty()) return;
  const double stop_mm = to_mm(data.stopping_distance_m);
  double max_mm = stop_mm;
  std::vector<std::string> least;
  for (const Distance& distance : distances) {
    for (const double mm : distance.series.y) max_mm = std::max(max_mm, mm);
    least.push_back(fmt::format("{} {:.0f} mm", distance.series.name, distance.min_mm));
  }
  std::reverse(least.begin(), least.end());
  const double end_s = std::max(data.duration_s, data.distances.back().time_s);
  Plot plot{.title = say("How far the arms kept from each other and from what is around them"),
            .x_label = say("time, s"),
            .y_label = say("distance, mm"),
            .x_low = 0.0,
            .x_high = end_s,
            .y_low = 0.0,
            .y_high = 1.05 * max_mm,
            .width_px = 1040,
            .height_px = 220};
  plot.series.push_back({.name = say("arms stop"),
                         .x = {0.0, end_s},
                         .y = {stop_mm, stop_mm},
                         .colour = palette::stop,
                         .dashed = true});
  for (const Distance& distance : distances) plot.series.push_back(distance.series);
  part.heading(say("How far they stayed apart"))
      .figure(to_svg(plot))
      .text(say("At the least: {}.", fmt::format("{}", fmt::join(least, say(", ")))))
      .note(say(
          "Between surfaces. Nearer to each other, to the couch or to the robot's body than the "
          "dashed line both arms stop. An arm's last link, with the tool, is meant to touch the "
          "person and is left out there; the upper arm hangs on the body and is left out beside "
          "it."));
}

}  // namespace

std::vector<KeyEntry> technique_key(const ReportData& data, bool moving) {
  const Language& say = data.language;
  std::vector<KeyEntry> key;
  for (const Technique technique : all_techniques) {
    const bool used =
        std::any_of(data.paths.begin(), data.paths.end(),
                    [&](const PerformedPath& p) { return p.path.technique == technique; });
    if (!used) continue;
    key.push_back(
        {colour_of(technique), figures::capital(say(row_of(technique).doing)), slides(technique)});
  }
  if (moving) {
    key.push_back({mix(palette::paper, palette::grey, 0.7), say("Moving through the air"), true});
    key.push_back({Colour{233, 235, 238}, say("Waiting")});
  }
  return key;
}

void add_conduct(Page& page, const ReportData& data) {
  const Language& say = data.language;
  Part& part = page.section(
      say("How it went"),
      say("The session in the order of time: what is being done, faintly what has been done, and "
          "the two arms that do it, drawn thinner than they are so that they hide less."));
  const std::size_t moments = moments_of(data).size();
  const std::string strip = session_strip(data);
  part.html(strip);
  if (strip.empty()) part.note(say("There is nothing to picture."));
  if (!strip.empty() && moments > max_pictures)
    part.note(say("{} of {} moments, evenly picked.", max_pictures, moments));
  part.heading(say("What each arm did when"));
  const std::string timeline = figures::timeline(data);
  if (timeline.empty()) {
    part.note(say("No path was carried out."));
  } else {
    part.figure(timeline).key(technique_key(data, true));
  }
  add_distances(part, data);
}

std::string given_in_words(const ReportData& data) {
  std::size_t ordered = 0, otherwise = 0, cut_short = 0, lowered = 0;
  for (const PerformedPath& performed : data.paths) {
    if (performed.ordered_n <= 0.0) continue;
    ++ordered;
    otherwise += !performed.why.empty();
    lowered += !performed.lowered_by.empty();
    cut_short += performed.why.empty() && !performed.contact_fault.empty();
  }
  const Language& say = data.language;
  std::string words;
  if (const std::size_t left_out = data.left_out.size(); left_out > 0)
    words += say("Ordered paths that were left out: {} of {}, see below. ", left_out,
                 ordered + left_out);
  if (ordered == 0) return words;
  if (lowered > 0)
    words += say("Paths for which the plan orders less than the programme: {} of {}. ", lowered,
                 ordered);
  if (otherwise + cut_short == 0) {
    return words + (data.left_out.empty()
                        ? say("Every place was given the force that the plan orders. ")
                        : say("Every other place was given the force that the plan orders. "));
  }
  if (otherwise > 0)
    words += say("Paths that were given another force than ordered: {} of {}, see below. ",
                 otherwise, ordered);
  if (cut_short > 0)
    words += say("Paths that were cut short: {} of {}, see below. ", cut_short, ordered);
  return words;
}

void add_given(Page& page, const ReportData& data) {
  const Language& say = data.language;
  Table table{.columns = {{.head = say("path")},
                          {.head = say("programme, N"), .digits = 1},
                          {.head = say("ordered, N"), .digits = 1},
                          {.head = say("given, N"), .digits = 1, .truth = data.simulated},
                          {.head = say("why")}}};
  for (const PerformedPath& performed : data.paths) {
    std::string why = say(performed.why);
    if (why.empty() && !performed.contact_fault.empty())
      why = say(sentence("why_cut_short", "cut short: {}", performed.contact_fault));
    if (!performed.lowered_by.empty()) {
      const std::string lowered = say("lowered for {}", say(performed.lowered_by));
      why = why.empty() ? lowered : fmt::format("{}{}{}", lowered, say("; "), why);
    }
    if (why.empty()) continue;
    table.add({figures::said_path(performed.path, say), performed.programme_n, performed.ordered_n,
               performed.given_n, why});
  }
  if (table.rows.empty() && data.left_out.empty()) return;
  Part& part = page.section(
      say("Given otherwise than asked for"),
      say("Where the plan orders less than the programme asks for, the given force is more "
          "than 5 % off the ordered one, or the path was cut short. A press or a tap counts by "
          "its largest force, what slides by its mean."));
  if (!data.left_out.empty()) part.heading(say("Left out")).list(say(data.left_out));
  if (!table.rows.empty()) part.table(table);
}

void add_decisions(Page& page, const ReportData& data) {
  if (data.decisions.empty()) return;
  const Language& say = data.language;
  Table table{.columns = {{.head = say("time, s"), .digits = 1},
                          {.head = say(Sentence{.words = "arm", .key = "which_arm"})},
                          {.head = say("path")},
                          {.head = say("rule")},
                          {.head = say("reason")},
                          {.head = say("planned, N"), .digits = 1},
                          {.head = say("decided, N"), .digits = 1}}};
  for (const SteeringDecision& made : data.decisions) {
    const auto decided =
        std::find_if(data.paths.begin(), data.paths.end(),
                     [&](const PerformedPath& one) { return one.path.name == made.path; });
    const std::string path =
        decided == data.paths.end() ? say(made.path) : figures::said_path(decided->path, say);
    table.add({made.time_s, say(name_of(made.arm)), path, made.rule,
               say(Sentence{.words = made.reason, .key = made.key}),
               made.from_n > 0.0 ? Cell(made.from_n) : Cell(), made.to_n});
  }
  page.section(
          say("What the tissue decided"),
          say("While it presses, the robot feels how hard and how thick the tissue is, and does "
              "less where less is right. Every change, with its reason; the rules are those of the "
              "manual."))
      .table(table);
}

}  // namespace tuina::telemetry
