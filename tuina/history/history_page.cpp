// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/history_page.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "tuina/record/session_report.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::history {
namespace {

using telemetry::Cell;

constexpr std::size_t max_maps = 3;

std::string wishes_of(const Visit& visit) {
  std::string wishes;
  if (visit.softer > 0) wishes = fmt::format("softer {} times", visit.softer);
  if (visit.firmer > 0) {
    wishes += wishes.empty() ? "" : ", ";
    wishes += fmt::format("firmer {} times", visit.firmer);
  }
  return wishes;
}

/// Place of a session among those that have ended, from 1: all of the page call it by that.
std::size_t number_of(const Visit& visit, std::span<const Visit> visits) {
  std::size_t number = 0;
  for (const Visit& one : visits) {
    if (one.ended) ++number;
    if (one.id == visit.id) break;
  }
  return number;
}

void add_sessions(telemetry::Page& page, std::span<const Visit> visits) {
  telemetry::Table table{.columns = {{.head = "session"},
                                     {.head = "when (UTC)"},
                                     {.head = "position"},
                                     {.head = "programme"},
                                     {.head = "minutes", .digits = 1},
                                     {.head = "force error, N RMS", .digits = 2},
                                     {.head = "highest force, N", .digits = 1},
                                     {.head = "wishes"},
                                     {.head = "how it ended"}}};
  for (const Visit& visit : visits) {
    if (!visit.ended) {
      table.add(
          {"-", day_and_time(visit.began), {}, {}, {}, {}, {}, {}, "cut short, without a record"});
      continue;
    }
    table.add({fmt::format("{}", number_of(visit, visits)), day_and_time(visit.began),
               visit.position, visit.programme, visit.duration_s / 60.0, visit.force_rmse_n,
               visit.force_peak_n, wishes_of(visit),
               visit.stops > 0 ? visit.stop_cause : "as planned"});
  }
  page.section("Sessions").table(table);
}

void add_change(telemetry::Page& page, std::span<const Visit> visits) {
  auto& part = page.section("What has changed");
  const auto last = last_change(visits);
  if (!last) {
    part.text("No place was felt in two sessions yet.");
    return;
  }
  part.text(sentence_of(*last));
  telemetry::Table table{
      .columns = {{.head = "place"},
                  {.head = fmt::format("alpha, N, session {}", number_of(*last->before, visits)),
                   .digits = 2},
                  {.head = fmt::format("session {}", number_of(*last->after, visits)), .digits = 2},
                  {.head = "change, %", .digits = 0},
                  {.head = "95 % interval"},
                  {.head = "real?"}}};
  const auto add = [&](const Change& one, std::string name) {
    table.rows.push_back(
        {.cells = {std::move(name), one.before_n, one.after_n, 100.0 * one.change,
                   fmt::format("{:+.0f} to {:+.0f} %", 100.0 * one.low, 100.0 * one.high),
                   one.real ? (one.change < 0.0 ? "softer" : "harder") : "not told apart"},
         .emphasised = one.real});
  };
  if (last->changes.whole) add(*last->changes.whole, "all places together");
  for (const Change& place : last->changes.places)
    add(place, telemetry::figures::spoken(place.name));
  part.table(table);
  part.note(fmt::format(
      "alpha is the hardness of the tissue. The same place scatters from session to session by "
      "{:.0f} %, {}. Changes are called real by a test over all places together, which is wrong in "
      "5 of 100 sessions in which nothing has changed. What all places share that day, such as the "
      "warmth of the room or another force sensor, looks like a change of the whole back.",
      100.0 * last->changes.scatter,
      last->changes.scatter_assumed ? "which is assumed as long as there are few sessions"
                                    : "told from the earlier sessions"));
}

/// One value of each place over the sessions, with its 95 % band.
struct Trend {
  const char* title;
  const char* label;
  double VisitTissue::*value;
  double VisitTissue::*ci95;
  double scale;
};
constexpr Trend trends[] = {
    {"stiffness", "stiffness, N/mm", &VisitTissue::stiffness_n_per_mm,
     &VisitTissue::stiffness_ci95_n_per_mm, 1.0},
    {"alpha", "alpha, N", &VisitTissue::alpha_n, &VisitTissue::alpha_ci95_n, 1.0},
    {"beta", "beta, 1/mm", &VisitTissue::beta_per_m, &VisitTissue::beta_ci95_per_m, 1e-3},
};

/// The last press of a place in a session.
const VisitTissue* felt_at(const Visit& visit, const std::string& name) {
  const VisitTissue* felt = nullptr;
  for (const VisitTissue& one : visit.tissue)
    if (one.name == name) felt = &one;
  return felt;
}

std::string trend_of(const Trend& trend, const std::string& name, std::span<const Visit> visits) {
  telemetry::Series line{.name = "", .colour = telemetry::palette::press, .dots = false};
  telemetry::Band band{.name = "95 %", .colour = telemetry::palette::press};
  double number = 0.0;
  for (const Visit& visit : visits) {
    if (!visit.ended) continue;
    number += 1.0;
    const VisitTissue* felt = felt_at(visit, name);
    if (felt == nullptr) continue;
    const double value = felt->*trend.value * trend.scale;
    const double half = felt->*trend.ci95 * trend.scale;
    if (!std::isfinite(value) || !std::isfinite(half)) continue;
    line.x.push_back(number);
    line.y.push_back(value);
    band.x.push_back(number);
    band.low.push_back(std::max(0.0, value - half));
    band.high.push_back(value + half);
  }
  if (line.x.size() < 2) return {};
  telemetry::Series dots = line;
  dots.dots = true;
  return telemetry::to_svg(
      telemetry::Plot{.title = fmt::format("{} at {} over the sessions", trend.title, name),
                      .x_label = "session",
                      .y_label = trend.label,
                      .series = {line, dots},
                      .bands = {band},
                      .x_low = 1.0,
                      .x_high = std::max(2.0, number),
                      .y_low = 0.0,
                      .x_counts = true,
                      .width_px = 380,
                      .height_px = 200});
}

void add_trends(telemetry::Page& page, std::span<const Visit> visits) {
  std::map<std::string, int> names;
  for (const Visit& visit : visits)
    for (const VisitTissue& felt : visit.tissue) ++names[felt.name];
  auto& part = page.section("Each place over time", "The band holds the value in 95 % of cases.");
  bool any = false;
  for (const auto& [name, count] : names) {
    std::vector<telemetry::Figure> figures;
    for (const Trend& trend : trends) {
      if (auto svg = trend_of(trend, name, visits); !svg.empty())
        figures.push_back({.svg = std::move(svg), .name = trend.title, .caption = {}});
    }
    if (figures.empty()) continue;
    any = true;
    part.heading(telemetry::figures::spoken(name)).figures(figures, 3);
  }
  if (!any) part.text("No place was felt in two sessions yet.");
}

void add_maps(telemetry::Page& page, std::span<const Visit> visits) {
  const auto ended = static_cast<std::size_t>(
      std::count_if(visits.begin(), visits.end(), [](const Visit& visit) { return visit.ended; }));
  std::vector<std::pair<const Visit*, telemetry::ReportData>> shown;
  std::vector<std::string> gone;
  double hardest_n_per_mm = 1e-9;
  for (std::size_t i = visits.size(); i-- > 0 && shown.size() < max_maps;) {
    if (!visits[i].ended) continue;
    auto data = record::read_record(visits[i].folder);
    if (!data) {
      gone.push_back(visits[i].folder);
      continue;
    }
    for (const VisitTissue& felt : visits[i].tissue)
      hardest_n_per_mm = std::max(hardest_n_per_mm, felt.stiffness_n_per_mm);
    shown.insert(shown.begin(), {&visits[i], std::move(*data)});
  }
  std::vector<telemetry::Figure> maps;
  for (const auto& [visit, data] : shown) {
    if (auto svg = telemetry::figures::tissue(data, hardest_n_per_mm); !svg.empty())
      maps.push_back({.svg = std::move(svg),
                      .name = fmt::format("Session {}, {}", number_of(*visit, visits),
                                          day_and_time(visit->began)),
                      .caption = {}});
  }
  auto& part = page.section(
      "The back, session by session",
      maps.size() < ended ? fmt::format("{} of {} sessions.", maps.size(), ended) : "");
  if (maps.empty()) part.text("No session with a map of the tissue.");
  part.figures(maps, max_maps);
  for (const std::string& folder : gone)
    part.note(fmt::format("{}: the record is not there any more.", folder));
}

}  // namespace

std::string history_page(const PersonHistory& person) {
  const auto& [who, visits, notes] = person;
  telemetry::Page page({.title = who + ": sessions",
                        .over = "tuina",
                        .heading = who,
                        .meta = visits.empty() ? std::string()
                                               : fmt::format("{} sessions since {}", visits.size(),
                                                             visits.front().began.substr(0, 10)),
                        .lead = {},
                        .footer = "The records of the sessions are the truth; this page is made of "
                                  "their index."});
  if (!notes.empty()) {
    std::vector<std::string> lines;
    lines.reserve(notes.size());
    for (const Note& note : notes) lines.push_back(day_and_time(note.at) + ": " + note.words);
    page.section("Notes").list(lines);
  }
  add_change(page, visits);
  add_sessions(page, visits);
  add_maps(page, visits);
  add_trends(page, visits);
  return page.str();
}

}  // namespace tuina::history
