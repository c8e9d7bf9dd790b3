// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/plot/svg_timeline.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry::figures {
namespace {

constexpr double max_gap_s = 0.25;  // rows further apart belong to two contacts
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// An unbroken stretch of one technique by one arm.
struct Contact {
  std::string name;
  double begin_s = 0.0;
  std::vector<const TraceRow*> rows;
};

const PerformedPath* path_at(const ReportData& data, const TraceRow& row) {
  constexpr double slack_s = 0.01;
  for (const PerformedPath& performed : data.paths) {
    if (performed.arm != row.arm || performed.path.technique != row.technique) continue;
    if (row.time_s >= performed.begin_s - slack_s && row.time_s <= performed.ended_s() + slack_s)
      return &performed;
  }
  return nullptr;
}

std::vector<Contact> contacts_of(const ReportData& data, Technique technique) {
  std::vector<Contact> contacts;
  for (const Arm arm : both_arms) {
    const TraceRow* last = nullptr;
    const PerformedPath* path = nullptr;
    for (const TraceRow& row : data.trace) {
      if (row.arm != arm || row.technique != technique) continue;
      // The rows of an approach may come before their path begins, those of a retreat after it
      // ends.
      const PerformedPath* here = path_at(data, row);
      const bool next_path = path != nullptr && here != nullptr && here != path;
      if (last == nullptr || row.time_s - last->time_s > max_gap_s || next_path) {
        contacts.push_back({.name = "", .begin_s = row.time_s, .rows = {}});
        path = nullptr;
      }
      if (path == nullptr && here != nullptr) {
        path = here;
        contacts.back().name = place_of(here->path, data.language);
      }
      contacts.back().rows.push_back(&row);
      last = &row;
    }
  }
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const Contact& a, const Contact& b) { return a.begin_s < b.begin_s; });
  return contacts;
}

/// Target, true and measured force of contacts set one behind the other.
Plot force_plot(const ReportData& data, const std::vector<Contact>& contacts, Technique technique) {
  const Language& say = data.language;
  Plot plot{.title = say("Force while {}", row_of(technique).doing),
            .x_label = say("time in contact, s"),
            .y_label = say("force, N")};
  Series truth{.name = data.simulated ? say("true (simulation)") : "",
               .colour = colour_of(technique),
               .width_px = 1.5};
  // Where the truth is not known, what was measured is what there is to see.
  Series measured{
      .name = say("measured"),
      .colour = data.simulated ? mix(palette::paper, palette::grey, 0.55) : truth.colour,
      .width_px = data.simulated ? 1.0 : truth.width_px};
  Series target{.name = say("target"), .colour = palette::ink, .width_px = 1.2, .dashed = true};
  double begin_s = 0.0;
  for (const Contact& contact : contacts) {
    if (contacts.size() > 1) plot.marks.push_back({.x = begin_s, .text = contact.name});
    double last_s = begin_s;
    for (const TraceRow* row : contact.rows) {
      last_s = begin_s + row->time_s - contact.begin_s;
      for (Series* series : {&measured, &truth, &target}) series->x.push_back(last_s);
      measured.y.push_back(row->measured_force_n);
      truth.y.push_back(row->true_force_n);
      target.y.push_back(row->target_n);
    }
    for (Series* series : {&measured, &truth, &target}) {
      series->x.push_back(last_s);
      series->y.push_back(nan);
    }
    begin_s = last_s + 0.15;
  }
  plot.series.push_back(std::move(measured));
  if (data.simulated) plot.series.push_back(std::move(truth));
  plot.series.push_back(std::move(target));
  double low = 0.0;
  for (const Series& series : plot.series) {
    for (const double value : series.y) low = std::isfinite(value) ? std::min(low, value) : low;
  }
  if (low > -0.5) plot.y_low = -0.5;
  return plot;
}

/// When an arm moved through the air, from where its tool was ten times a second.
std::vector<Span> travels_of(const ReportData& data, Arm arm) {
  constexpr double every_s = 0.1, moves_m_per_s = 0.01, pause_s = 0.35;
  std::vector<Span> spans;
  const TraceRow* last = nullptr;
  for (const TraceRow& row : data.trace) {
    if (row.arm != arm || (last != nullptr && row.time_s - last->time_s < every_s - 1e-6)) continue;
    const bool moves = last != nullptr && !row.technique && !last->technique &&
                       (row.tool_in_couch - last->tool_in_couch).norm() >
                           moves_m_per_s * (row.time_s - last->time_s);
    if (moves && !spans.empty() && last->time_s - spans.back().end_s < pause_s) {
      spans.back().end_s = row.time_s;
    } else if (moves) {
      spans.push_back({.begin_s = last->time_s,
                       .end_s = row.time_s,
                       .text = data.language("moves through the air"),
                       .colour = mix(palette::paper, palette::grey, 0.7),
                       .thin = true});
    }
    last = &row;
  }
  return spans;
}

}  // namespace

std::string force(const ReportData& data, Technique technique) {
  const auto contacts = contacts_of(data, technique);
  if (contacts.empty()) return "";
  Plot plot = force_plot(data, contacts, technique);
  plot.width_px = 1040;
  plot.height_px = 250;
  return to_svg(plot);
}

std::string first_press_force(const ReportData& data) {
  auto contacts = contacts_of(data, Technique::press);
  if (contacts.empty()) return "";
  contacts.resize(1);
  Plot plot = force_plot(data, contacts, Technique::press);
  plot.title = data.language("The first press, close up: force");
  plot.x_label = data.language("time since contact was sought, s");
  plot.width_px = 510;
  plot.height_px = 260;
  return to_svg(plot);
}

std::string first_press_depth(const ReportData& data) {
  auto contacts = contacts_of(data, Technique::press);
  if (contacts.empty()) return "";
  Plot plot{.title = data.language("The first press, close up: depth"),
            .x_label = data.language("time since contact was sought, s"),
            .y_label = data.language("depth below the skin, mm")};
  Series depth{.name = "", .colour = colour_of(Technique::press)};
  for (const TraceRow* row : contacts.front().rows) {
    depth.x.push_back(row->time_s - contacts.front().begin_s);
    depth.y.push_back(to_mm(row->depth_m));
  }
  plot.series.push_back(std::move(depth));
  plot.width_px = 510;
  plot.height_px = 260;
  return to_svg(plot);
}

std::string timeline(const ReportData& data) {
  const Language& say = data.language;
  Timeline timeline{.title = say("What each arm did when"),
                    .x_label = say("time, s"),
                    .end_s = data.duration_s,
                    .width_px = 1040};
  for (const Arm arm : both_arms) {
    TimelineRow row{.name = say("{} arm", name_of(arm)), .spans = travels_of(data, arm)};
    for (const PerformedPath& performed : data.paths) {
      if (performed.arm != arm) continue;
      const double end_s = performed.ended_s();
      std::string text = performed.path.acupoints.empty() ? place_of(performed.path, say)
                                                          : performed.path.acupoints.front();
      std::replace(text.begin(), text.end(), '_', ' ');
      row.spans.push_back({.begin_s = performed.begin_s,
                           .end_s = end_s,
                           .text = text,
                           .colour = colour_of(performed.path.technique)});
      timeline.end_s = std::max(timeline.end_s, end_s);
    }
    timeline.rows.push_back(std::move(row));
  }
  for (const Stop& stop : data.stops) {
    timeline.marks.push_back({.x = stop.time_s, .text = say("stop"), .colour = palette::stop});
  }
  return data.paths.empty() ? "" : to_svg(timeline);
}

}  // namespace tuina::telemetry::figures
