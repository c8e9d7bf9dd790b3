// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/fleet_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "tuina/core/units.hpp"
#include "tuina/history/person_history.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::history {
namespace {

constexpr double seconds_a_day = 86400.0;
constexpr std::size_t max_stops_shown = 50;

double days_between(const std::string& from, const std::string& to) {
  return seconds_between(from, to) / seconds_a_day;
}

/// "3 minutes", "2 days": the largest unit that fits.
std::string spoken_time(double seconds) {
  struct Unit {
    const char* name;
    double seconds;
  };
  for (const Unit& unit :
       {Unit{"day", seconds_a_day}, Unit{"hour", 3600.0}, Unit{"minute", 60.0}}) {
    if (seconds < unit.seconds) continue;
    const double whole = std::floor(seconds / unit.seconds);
    return fmt::format("{:.0f} {}{}", whole, unit.name, whole == 1.0 ? "" : "s");
  }
  return fmt::format("{:.0f} s", std::max(0.0, seconds));
}

std::string doing_of(const Machine& machine, const std::string& now) {
  const double silent_s = seconds_between(machine.seen, now);
  if (machine.doing == "switched off") return "off since " + day_and_time(machine.seen);
  if (silent_s <= max_silence_s) return machine.doing;
  return fmt::format("not heard for {}, then: {}", spoken_time(silent_s), machine.doing);
}

/// One that is under way has not ended either: the newest, as long as its robot is heard.
bool cut_short(const MachineHistory& one, const MachineSession& session, const std::string& now) {
  if (session.ended) return false;
  const bool heard = seconds_between(one.machine.seen, now) <= max_silence_s;
  const bool at_it = one.machine.doing != "idle" && one.machine.doing != "switched off";
  return !(heard && at_it && &session == &one.sessions.back());
}

std::string cause_of(const MachineSession& session) {
  return session.ended ? session.stop_cause : "cut short, without a record";
}

void add_stops(telemetry::Page& page, std::span<const MachineHistory> fleet,
               const std::string& now) {
  struct Stop {
    const Machine* machine;
    const MachineSession* session;
  };
  std::vector<Stop> stops;
  std::map<std::string, int> causes;
  for (const MachineHistory& one : fleet) {
    for (const MachineSession& session : one.sessions) {
      if (session.stops == 0 && !cut_short(one, session, now)) continue;
      stops.push_back({&one.machine, &session});
      ++causes[cause_of(session)];
    }
  }
  auto& part = page.section("Stops");
  if (stops.empty()) {
    part.calm("No session was stopped or cut short.");
    return;
  }
  std::ranges::sort(
      stops, [](const Stop& a, const Stop& b) { return a.session->began > b.session->began; });
  std::vector<std::string> counted;
  counted.reserve(causes.size());
  for (const auto& [cause, times] : causes) counted.push_back(fmt::format("{}: {}", cause, times));
  part.list(counted);
  telemetry::Table table{
      .columns = {{.head = "session began (UTC)"}, {.head = "robot"}, {.head = "first cause"}}};
  for (const Stop& stop : stops) {
    if (table.rows.size() == max_stops_shown) break;
    table.add({day_and_time(stop.session->began), stop.machine->name, cause_of(*stop.session)});
  }
  part.table(table);
  if (stops.size() > max_stops_shown)
    part.note(fmt::format("The newest {} of {}.", max_stops_shown, stops.size()));
}

/// A curve of a figure: the value of a session.
struct Curve {
  const char* name;
  telemetry::Colour colour;
  std::function<double(const MachineSession&)> value;
};
/// The same figure for every robot, with the same axes, so that they can be compared.
struct RobotFigure {
  const char* title;
  const char* y_label;
  std::vector<Curve> curves;
};

std::vector<RobotFigure> robot_figures() {
  using telemetry::palette::press, telemetry::palette::ink;
  const auto zero_of = [](Arm arm) {
    return [arm](const MachineSession& session) { return session.zero_n[arm]; };
  };
  return {{"Drift of the wrist sensors",
           "force in the air, N",
           {{"left", telemetry::colour_of(Arm::left), zero_of(Arm::left)},
            {"right", telemetry::colour_of(Arm::right), zero_of(Arm::right)}}},
          {"Accuracy of the force",
           "force error, N RMS",
           {{"", press, [](const auto& session) { return session.force_rmse_n; }}}},
          {"Accuracy of the scan",
           "mm",
           {{"scan, RMS", ink, [](const auto& session) { return to_mm(session.scan_rms_m); }},
            {"acupoints, 95 %", press,
             [](const auto& session) { return to_mm(session.uncertainty_m); }}}}};
}

/// The largest and the smallest of all robots, and zero.
std::pair<double, double> range_of(const RobotFigure& figure,
                                   std::span<const MachineHistory> fleet) {
  double low = 0.0, high = 0.0;
  for (const MachineHistory& one : fleet) {
    for (const MachineSession& session : one.sessions) {
      for (const Curve& curve : figure.curves) {
        const double value = curve.value(session);
        if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
      }
    }
  }
  return {low, high > low ? high : low + 1.0};
}

/// Over the days up to now; empty where nothing is known.
std::string draw(const RobotFigure& figure, const MachineHistory& one, const std::string& now,
                 std::pair<double, double> range) {
  telemetry::Plot plot{.title = figure.title,
                       .x_label = "days ago",
                       .y_label = figure.y_label,
                       .x_high = 0.0,
                       .y_low = range.first,
                       .y_high = range.second,
                       .width_px = 380,
                       .height_px = 200};
  for (const Curve& curve : figure.curves) {
    telemetry::Series dots{.name = curve.name, .colour = curve.colour, .dots = true};
    for (const MachineSession& session : one.sessions) {
      const double value = curve.value(session);
      if (!session.ended || !std::isfinite(value)) continue;
      dots.x.push_back(-days_between(session.began, now));
      dots.y.push_back(value);
    }
    if (!dots.x.empty()) plot.series.push_back(std::move(dots));
  }
  return plot.series.empty() ? std::string() : telemetry::to_svg(plot);
}

void add_robots(telemetry::Page& page, std::span<const MachineHistory> fleet,
                const std::string& now) {
  auto& part = page.section(
      "Over time",
      "In the air a wrist should feel nothing; the mean of a session tells its drift.");
  const std::vector<RobotFigure> figures = robot_figures();
  for (const MachineHistory& one : fleet) {
    std::vector<telemetry::Figure> drawn;
    for (const RobotFigure& figure : figures) {
      if (auto svg = draw(figure, one, now, range_of(figure, fleet)); !svg.empty())
        drawn.push_back({.svg = std::move(svg), .name = figure.title, .caption = {}});
    }
    part.heading(one.machine.name);
    if (drawn.empty()) {
      part.text("No session with a record yet.");
    } else {
      part.figures(drawn, 3);
    }
  }
}

}  // namespace

double seconds_between(const std::string& from, const std::string& to) {
  const auto seconds = [](const std::string& stamp) {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    if (std::sscanf(stamp.c_str(), "%4d-%2d-%2dT%2d:%2d:%2dZ", &year, &month, &day, &hour, &minute,
                    &second) != 6)
      return std::numeric_limits<double>::quiet_NaN();
    using namespace std::chrono;
    const sys_days date = std::chrono::year(year) / month / day;
    return static_cast<double>(date.time_since_epoch().count()) * seconds_a_day + hour * 3600.0 +
           minute * 60.0 + second;
  };
  return seconds(to) - seconds(from);
}

telemetry::Table fleet_table(std::span<const MachineHistory> fleet, const std::string& now) {
  telemetry::Table table{
      .columns = {{.head = "robot", .key = "robot"},
                  {.head = "model", .key = "model"},
                  {.head = "now", .key = "doing"},
                  {.key = "seen"},
                  {.head = "last session (UTC)", .key = "last_session"},
                  {.head = "sessions", .key = "sessions"},
                  {.head = "stopped", .key = "stopped"},
                  {.head = "cut short", .key = "cut_short"},
                  {.head = "calibrated, days ago", .key = "calibration_age_days", .digits = 0},
                  {.head = "force error, N RMS", .key = "force_rmse_n", .digits = 2},
                  {.head = "in the air, N: left", .key = "left_zero_n", .digits = 2},
                  {.head = "right", .key = "right_zero_n", .digits = 2},
                  {.head = "version", .key = "version"}}};
  for (const MachineHistory& one : fleet) {
    std::int64_t stopped = 0, cut = 0;
    const MachineSession* last = nullptr;
    for (const MachineSession& session : one.sessions) {
      stopped += session.stops > 0 ? 1 : 0;
      cut += cut_short(one, session, now) ? 1 : 0;
      if (session.ended && std::isfinite(session.force_rmse_n)) last = &session;
    }
    const auto newest = [&](double value) {
      return last != nullptr && std::isfinite(value) ? telemetry::Cell(value) : telemetry::Cell();
    };
    const MachineSession none;
    const MachineSession& did = last != nullptr ? *last : none;
    table.add({one.machine.name, one.machine.model, doing_of(one.machine, now), one.machine.seen,
               one.sessions.empty() ? telemetry::Cell()
                                    : telemetry::Cell(day_and_time(one.sessions.back().began)),
               one.sessions.size(), stopped, cut,
               one.machine.calibrated.empty()
                   ? telemetry::Cell()
                   : telemetry::Cell(days_between(one.machine.calibrated, now)),
               newest(did.force_rmse_n), newest(did.zero_n[Arm::left]),
               newest(did.zero_n[Arm::right]), one.machine.version});
  }
  return table;
}

std::string fleet_page(std::span<const MachineHistory> fleet, const std::string& now) {
  std::size_t sessions = 0;
  for (const MachineHistory& one : fleet) sessions += one.sessions.size();
  telemetry::Page page({.title = "Robots",
                        .over = "tuina",
                        .heading = "Robots",
                        .meta = fmt::format("{} robot{}, {} session{}; {} UTC", fleet.size(),
                                            fleet.size() == 1 ? "" : "s", sessions,
                                            sessions == 1 ? "" : "s", day_and_time(now)),
                        .lead = {},
                        .footer = "What robots have told of themselves; nothing of the people."});
  auto& part = page.section("Now");
  part.table(fleet_table(fleet, now));
  part.note(
      "Forces are those of the last session with a record. A robot that tells nothing for a minute "
      "is not heard; its sessions come when its network does.");
  add_stops(page, fleet, now);
  add_robots(page, fleet, now);
  return page.str();
}

}  // namespace tuina::history
