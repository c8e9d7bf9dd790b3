// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/cli/table.hpp"
#include "apps/evaluation/safety/judge.hpp"

namespace tuina::app {
namespace {

using telemetry::Table;

std::string titled(const FaultClass& fault) {
  return fmt::format("{} {}", fault.number, fault.name);
}

}  // namespace

std::string state_of(const CampaignCell& cell) {
  const std::string stage = name_of(cell.plan.stage);
  return cell.plan.stage == Stage::contact ? "contact " + cell.plan.site->spot : stage;
}

Table failed_table(const Campaign& campaign) {
  Table table{.title = "Promises that are not kept",
              .columns = {{.head = "class", .key = "class"},
                          {.head = "state", .key = "state"},
                          {.head = "place", .key = "place"},
                          {.head = "force, N", .key = "worst_force_n", .digits = 0},
                          {.head = "acts, ms", .key = "first_action_ms", .digits = 0},
                          {.head = "end", .key = "end"},
                          {.head = "cause", .key = "cause"},
                          {.head = "why", .key = "why"}}};
  for (const CampaignCell& cell : campaign.cells) {
    if (cell.holds()) continue;
    const TrialOutcome& outcome = cell.outcome;
    table.add({titled(*cell.fault), name_of(cell.plan.stage), cell.plan.site->name,
               outcome.worst_force_n, outcome.first_action_ms, outcome.end, outcome.cause,
               fmt::format("{}", fmt::join(cell.broken, "; "))});
  }
  return table;
}

Table class_table(const Campaign& campaign) {
  Table table{
      .title = "Classes",
      .columns = {{.head = "class", .key = "class"},
                  {.head = "cells", .key = "cells"},
                  {.head = "kept", .key = "kept"},
                  {.head = "force, N", .key = "worst_force_n", .digits = 0},
                  {.head = "above what is allowed, N", .key = "worst_excess_n", .digits = 0},
                  {.head = "acts after at most, ms", .key = "first_action_ms", .digits = 0},
                  {.head = "never acts", .key = "never_acts"}}};
  for (const FaultClass& fault : fault_classes()) {
    int cells = 0, kept = 0, silent = 0;
    double worst_n = 0.0, action_ms = std::numeric_limits<double>::quiet_NaN();
    double excess_n = -std::numeric_limits<double>::infinity();
    for (const CampaignCell& cell : campaign.cells) {
      if (cell.fault != &fault) continue;
      const TrialOutcome& outcome = cell.outcome;
      ++cells;
      kept += cell.holds() ? 1 : 0;
      silent += outcome.tried && std::isnan(outcome.first_action_ms) ? 1 : 0;
      worst_n = std::max(worst_n, outcome.worst_force_n);
      excess_n =
          std::max(excess_n, outcome.worst_force_n - allowed_n(fault.promise, outcome.set_force_n));
      action_ms = std::fmax(action_ms, outcome.first_action_ms);
    }
    if (cells > 0) table.add({titled(fault), cells, kept, worst_n, excess_n, action_ms, silent});
  }
  return table;
}

Table pair_table(const Campaign& campaign) {
  Table table{.title = "Two faults at once",
              .columns = {{.head = "first", .key = "first"},
                          {.head = "second", .key = "second"},
                          {.head = "force, N", .key = "worst_force_n", .digits = 0},
                          {.head = "worst place", .key = "place"},
                          {.head = "", .key = "held"}}};
  for (const FaultPair& pair : campaign.pairs) {
    table.add({titled(*pair.first), titled(*pair.second), pair.worst_force_n,
               pair.worst_plan.site->name, pair.holds()});
    table.rows.back().emphasised = !pair.holds();
  }
  return table;
}

Table site_table(const Campaign& campaign) {
  Table table{.title = "Places",
              .columns = {{.head = "place", .key = "place"},
                          {.head = "zone", .key = "zone"},
                          {.head = "pressed with, N", .key = "force_n", .digits = 0},
                          {.head = "apparent mass, kg", .key = "apparent_mass_kg", .digits = 1}}};
  for (const Site& site : campaign.sites)
    table.add({site.name, name_of(site.zone), site.force_n, site.apparent_mass_kg});
  return table;
}

Table session_table(const Campaign& campaign) {
  Table table{.title = "Scans and sessions",
              .columns = {{.head = "class", .key = "class"},
                          {.head = "state", .key = "state"},
                          {.head = "person", .key = "person"},
                          {.head = "what became of it", .key = "found"},
                          {.head = "", .key = "held"},
                          {.head = "why", .key = "why"}}};
  for (const SessionCell& cell : campaign.sessions) {
    table.add({fmt::format("{} {}", cell.number, cell.name), cell.state, cell.person, cell.found,
               cell.holds(), fmt::format("{}", fmt::join(cell.broken, "; "))});
    table.rows.back().emphasised = !cell.holds();
  }
  return table;
}

Table worst_table(const Campaign& campaign) {
  Table table{.title = "The worst that a search found",
              .columns = {{.head = "class", .key = "class"},
                          {.head = "state", .key = "state"},
                          {.head = "place", .key = "place"},
                          {.head = "apparent mass, kg", .key = "apparent_mass_kg", .digits = 1},
                          {.head = "force, N", .key = "worst_force_n", .digits = 0},
                          {.head = "allowed, N", .key = "allowed_n", .digits = 0},
                          {.head = "", .key = "held"}}};
  for (const WorstTrial& one : campaign.worst) {
    table.add({titled(*one.fault), name_of(one.plan.stage), one.plan.site->name,
               one.plan.site->apparent_mass_kg, one.worst_force_n, one.allowed_n, one.holds()});
    table.rows.back().emphasised = !one.holds();
  }
  return table;
}

/// Each with how often it stopped somebody.
std::string in_words(const std::map<std::string, int>& causes) {
  std::vector<std::string> words;
  words.reserve(causes.size());
  for (const auto& [cause, times] : causes) words.push_back(fmt::format("{} {}", times, cause));
  return fmt::format("{}", fmt::join(words, ", "));
}

Table people_table(const Campaign& campaign) {
  Table table{.title = "People without a fault",
              .columns = {{.head = "what they do", .key = "does"},
                          {.head = "people", .key = "people"},
                          {.head = "stopped by the guard", .key = "stopped"},
                          {.head = "let go, to be scanned again", .key = "let_go"},
                          {.head = "force, N", .key = "worst_force_n", .digits = 0},
                          {.head = "above what is set, N", .key = "worst_over_n", .digits = 0},
                          {.head = "causes", .key = "causes"}}};
  for (const char* does : {"breathes", "coughs", "shifts"}) {
    int people = 0, stopped = 0, let_go = 0;
    double worst_n = 0.0, over_n = 0.0;
    std::map<std::string, int> causes;
    for (const PersonRun& one : campaign.people) {
      if (one.does != does) continue;
      ++people;
      worst_n = std::max(worst_n, one.outcome.worst_force_n);
      over_n = std::max(over_n, one.outcome.worst_force_n - one.outcome.set_force_n);
      if (!one.outcome.stopped) continue;
      ++(one.outcome.by_guard ? stopped : let_go);
      ++causes[one.outcome.cause];
    }
    if (people > 0) table.add({does, people, stopped, let_go, worst_n, over_n, in_words(causes)});
  }
  const double not_looked_at = std::numeric_limits<double>::quiet_NaN();
  int press_stopped = 0, press_let_go = 0;
  std::map<std::string, int> press_causes;
  for (const TrialOutcome& one : campaign.clean) {
    if (!one.stopped) continue;
    ++(one.by_guard ? press_stopped : press_let_go);
    ++press_causes[one.cause];
  }
  if (!campaign.clean.empty())
    table.add({"breathes quietly", static_cast<int>(campaign.clean.size()), press_stopped,
               press_let_go, not_looked_at, not_looked_at, in_words(press_causes)});
  if (campaign.clean_sessions.empty()) return table;
  int stopped = 0;
  double worst_n = 0.0;
  std::map<std::string, int> causes;
  for (const CleanSession& one : campaign.clean_sessions) {
    stopped += one.stops.empty() ? 0 : 1;
    worst_n = std::max(worst_n, one.max_force_n);
    for (const std::string& stop : one.stops) ++causes[stop];
  }
  table.add({"sessions of 20 minutes", static_cast<int>(campaign.clean_sessions.size()), stopped,
             telemetry::Cell(), worst_n, not_looked_at, in_words(causes)});
  return table;
}

Table elsewhere_table() {
  Table table{.title = "Faults of the list that are held elsewhere, or have no surface",
              .columns = {{.head = "fault", .key = "fault"}, {.head = "where", .key = "where"}}};
  for (const auto& [fault, where] :
       {std::pair{"29 wrong calibration",
                  "refused when it is read: tests of scanner and calibration"},
        {"30 hostile files",
         "refused when they are read: tests/fuzz, tests/whole/bad_input_test.cpp"},
        {"31 to 36 pages, networks, strangers, two operators",
         "tests/web/serve_hostile.py, serve_massage.py; tuina evaluate armlink"},
        {"37 stop during a scan", "tests/web/serve_massage.py"},
        {"38 disk full", "tuina evaluate processes"},
        {"39 killed while it writes",
         "test_history, test_record; other files are whole or not there"},
        {"42 memory, processors", "tuina evaluate processes"},
        {"44 contacts of the stop bounce", "no surface: the chain is hardware"}})
    table.add({fault, where});
  return table;
}

std::string summary_of(const Campaign& campaign) {
  const auto failed = std::count_if(campaign.cells.begin(), campaign.cells.end(),
                                    [](const auto& cell) { return !cell.holds(); });
  const auto held = std::count_if(campaign.pairs.begin(), campaign.pairs.end(),
                                  [](const auto& pair) { return pair.holds(); });
  std::string text;
  if (!campaign.cells.empty())
    text += fmt::format("{} of {} cells keep all promises. ",
                        campaign.cells.size() - static_cast<std::size_t>(failed),
                        campaign.cells.size());
  if (!campaign.pairs.empty())
    text += fmt::format("{} of {} pairs of faults stay below {:.0f} N. ", held,
                        campaign.pairs.size(), double_fault_n);
  if (!campaign.sessions.empty()) {
    const auto kept = std::count_if(campaign.sessions.begin(), campaign.sessions.end(),
                                    [](const auto& cell) { return cell.holds(); });
    text += fmt::format("{} of {} faulted scans and sessions keep theirs. ", kept,
                        campaign.sessions.size());
  }
  if (!campaign.random.empty())
    text += fmt::format(
        "{} of {} random trials do what no fault may do: with 95 % confidence less than {:.2f} % "
        "of "
        "such trials. ",
        campaign.violations(), campaign.random.size(), 100.0 * campaign.violation_bound());
  if (!campaign.worst.empty()) {
    const auto kept = std::count_if(campaign.worst.begin(), campaign.worst.end(),
                                    [](const auto& one) { return one.holds(); });
    text += fmt::format(
        "With {} trials each, a search finds more than is allowed in {} of {} "
        "classes. ",
        campaign.order.search_trials, campaign.worst.size() - static_cast<std::size_t>(kept),
        campaign.worst.size());
  }
  text += fmt::format(
      "The largest true force of all is {:.0f} N. Without a fault, or before it came, {} runs were "
      "stopped.",
      campaign.worst_force_n(), campaign.false_stops());
  return text;
}

std::string to_json(const Campaign& campaign) {
  const std::vector<double> actions_ms = campaign.first_actions_ms();
  const auto held = std::count_if(campaign.pairs.begin(), campaign.pairs.end(),
                                  [](const auto& pair) { return pair.holds(); });
  nlohmann::ordered_json json = {{"seed", campaign.order.seed},
                                 {"realism", campaign.order.config.simulation.realism},
                                 {"full", campaign.order.full}};
  json["cells"] = campaign.cells.size();
  json["failed"] = to_json(failed_table(campaign));
  json["double_faults"] = {{"held", held}, {"of", campaign.pairs.size()}};
  json["sessions"] = {{"run", campaign.random.size()},
                      {"violations", campaign.violations()},
                      {"bound", campaign.violation_bound()},
                      {"told", to_json(random_table(campaign))}};
  json["worst_force_n"] = campaign.worst_force_n();
  json["first_action_ms"] = {{"median", nullptr}, {"max", nullptr}};
  if (!actions_ms.empty())
    json["first_action_ms"] = {{"median", actions_ms[actions_ms.size() / 2]},
                               {"max", actions_ms.back()}};
  json["false_stops"] = campaign.false_stops();
  json["scans_and_sessions"] = to_json(session_table(campaign));
  json["people"] = to_json(people_table(campaign));
  json["worst"] = nlohmann::ordered_json::parse(to_json(campaign.worst));
  json["classes"] = to_json(class_table(campaign));
  json["pairs"] = to_json(pair_table(campaign));
  json["places"] = to_json(site_table(campaign));
  return json.dump(2);
}

std::string to_text(const Campaign& campaign) {
  std::string text = summary_of(campaign) + fmt::format(" Simulation only, world `{}`.\n",
                                                        campaign.order.config.simulation.realism);
  for (const Table& table : {class_table(campaign), pair_table(campaign), session_table(campaign),
                             people_table(campaign), worst_table(campaign), random_table(campaign),
                             failed_table(campaign)})
    if (!table.rows.empty()) text += "\n" + to_text(table);
  return text;
}

}  // namespace tuina::app
