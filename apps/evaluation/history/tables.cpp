// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/history/tables.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace tuina::app {

telemetry::Table days_table(const std::vector<Result<DaysOfOne>>& people) {
  telemetry::Table table{
      .title = "People who come back",
      .columns = {
          {.head = "they come back", .key = "return"},
          {.key = "sessions"},
          {.key = "refused"},
          {.head = "places", .key = "places"},
          {.head = "known", .key = "known"},
          {.head = "one press", .key = "spared"},
          {.head = "dropped", .key = "dropped"},
          {.head = "probing, s a place", .key = "probing_s", .digits = 2},
          {.head = "massage, s", .key = "massage_s", .digits = 1},
          {.head = "within 5 %, %", .key = "within_percent", .digits = 1, .truth = true},
          {.head = "highest, % of plan", .key = "highest_percent", .digits = 1, .truth = true},
          {.head = "highest probe, %", .key = "highest_probe_percent", .digits = 1, .truth = true},
          {.head = "over cap, N", .key = "over_cap_n", .digits = 2, .truth = true},
          {.head = "over trip, N", .key = "over_trip_n", .digits = 2, .truth = true}}};
  for (std::size_t i = 0; i < returns.size(); ++i) {
    int refused = 0, sessions = 0, places = 0, known = 0, spared = 0, dropped = 0, within = 0;
    double probing_s = 0.0, massage_s = 0.0, highest = 0.0, highest_probe = 0.0;
    double over_cap_n = -1e9, over_trip_n = -1e9;
    std::size_t given = 0;
    for (const Result<DaysOfOne>& person : people) {
      const ReturnOutcome& day = person->days[i];
      if (!day.refused.empty()) {
        ++refused;
        continue;
      }
      ++sessions;
      places += day.places;
      known += day.known;
      spared += day.spared;
      dropped += day.dropped;
      probing_s += day.probing_s;
      massage_s += day.massage_s;
      given += day.given.size();
      for (const double share : day.given) {
        within += std::abs(share - 1.0) <= 0.05 ? 1 : 0;
        highest = std::max(highest, share);
      }
      for (const double share : day.probed) highest_probe = std::max(highest_probe, share);
      over_cap_n = std::max(over_cap_n, day.over_cap_n);
      over_trip_n = std::max(over_trip_n, day.over_trip_n);
    }
    table.add({returns[i].name, sessions, refused, places, known, spared, dropped,
               probing_s / std::max(places, 1), massage_s / std::max(sessions, 1),
               100.0 * within / static_cast<double>(std::max<std::size_t>(given, 1)),
               100.0 * highest, 100.0 * highest_probe, over_cap_n, over_trip_n});
  }
  return table;
}

telemetry::Table power_table(const std::vector<Result<PowerOutcome>>& tested) {
  telemetry::Table table{
      .title = "Alpha harder by 10 %, five presses, 20 places, 5 % false alarms",
      .columns = {{.head = "felt", .key = "world"},
                  {.head = "scatter, %", .key = "scatter_percent", .digits = 0},
                  {.key = "people"},
                  {.head = "one place: found, %", .key = "power_percent", .digits = 1},
                  {.head = "all places: found, %", .key = "whole_percent", .digits = 1},
                  {.head = "told, %", .key = "whole_change_percent", .digits = 1},
                  {.head = "each of them, %", .key = "power_of_all_percent", .digits = 1},
                  {.head = "false alarms, %", .key = "false_percent", .digits = 1},
                  {.head = "scatter told, %", .key = "told_percent", .digits = 1}}};
  for (std::size_t k = 0; k < power_worlds.size(); ++k) {
    int people = 0, places = 0, found = 0, found_of_all = 0, whole = 0, wrong = 0;
    double told = 0.0, change = 0.0;
    for (std::size_t i = k; i < tested.size(); i += power_worlds.size()) {
      const PowerOutcome& one = *tested[i];
      ++people;
      places += one.places;
      found += one.found;
      found_of_all += one.found_of_all;
      whole += one.found_whole ? 1 : 0;
      wrong += one.false_alarm ? 1 : 0;
      told += one.scatter;
      change += one.whole_change;
    }
    const double n = std::max(people, 1), of = std::max(places, 1);
    table.add({power_worlds[k].name, 100.0 * power_worlds[k].scatter, people, 100.0 * found / of,
               100.0 * whole / n, 100.0 * change / n, 100.0 * found_of_all / of, 100.0 * wrong / n,
               100.0 * told / n});
  }
  return table;
}

telemetry::Table points_table(const std::vector<Result<PointsOutcome>>& people) {
  telemetry::Table table{
      .title = "Acupoints of people who come back, mm over the seven",
      .columns = {{.head = "a finger has shown", .key = "shown"},
                  {.key = "people"},
                  {.head = "refused", .key = "refused"},
                  {.head = "mean", .key = "mean_mm", .digits = 1},
                  {.head = "of a stranger's, %", .key = "of_stranger_percent", .digits = 0},
                  {.head = "within the radius, %", .key = "within_percent", .digits = 0}}};
  for (std::size_t set = 0; set < shown_sets.size(); ++set) {
    int known = 0, refused = 0, within = 0;
    double sum_mm = 0.0, stranger_mm = 0.0;
    for (const Result<PointsOutcome>& one : people) {
      if (one->error_mm.empty()) continue;
      if (!std::isfinite(one->error_mm[set])) {
        ++refused;
        continue;
      }
      ++known;
      within += one->within[set];
      sum_mm += one->error_mm[set];
      stranger_mm += one->error_mm[0];
    }
    const double n = std::max(known, 1);
    table.add({set == 0 ? std::string("nothing: a stranger")
                        : fmt::format("{}", fmt::join(shown_sets[set], ", ")),
               known, refused, sum_mm / n, 100.0 * sum_mm / std::max(stranger_mm, 1e-9),
               100.0 * within / (n * static_cast<double>(seven_acupoints.size()))});
  }
  return table;
}

telemetry::Table others_table(const std::vector<Result<PointsOutcome>>& people) {
  telemetry::Table table{
      .title = "With the history of somebody else, GV4 shown",
      .columns = {{.key = "histories"},
                  {.head = "noticed, %", .key = "noticed_percent", .digits = 1},
                  {.head = "not noticed", .key = "unnoticed"},
                  {.head = "points then off, mm more: mean", .key = "harm_mm", .digits = 1},
                  {.head = "most", .key = "max_harm_mm", .digits = 1},
                  {.head = "beyond their radius", .key = "beyond"},
                  {.head = "own scans apart, mm: most", .key = "max_misfit_mm", .digits = 1}}};
  int others = 0, noticed = 0, beyond = 0;
  double harm_mm = 0.0, max_harm_mm = 0.0, max_misfit_mm = 0.0;
  for (const Result<PointsOutcome>& one : people) {
    others += one->others;
    noticed += one->noticed;
    beyond += one->beyond;
    max_misfit_mm = std::max(max_misfit_mm, one->misfit_mm);
    for (const double more_mm : one->harm_mm) {
      harm_mm += more_mm;
      max_harm_mm = std::max(max_harm_mm, more_mm);
    }
  }
  const int unnoticed = others - noticed;
  table.add({others, 100.0 * noticed / std::max(others, 1), unnoticed,
             harm_mm / std::max(unnoticed, 1), max_harm_mm, beyond, max_misfit_mm});
  return table;
}

}  // namespace tuina::app
