// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
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

std::string summary_of(const Campaign& campaign) {
  const auto failed = std::count_if(campaign.cells.begin(), campaign.cells.end(),
                                    [](const auto& cell) { return !cell.holds(); });
  const auto held = std::count_if(campaign.pairs.begin(), campaign.pairs.end(),
                                  [](const auto& pair) { return pair.holds(); });
  return fmt::format(
      "{} of {} cells keep all promises, {} of {} pairs of faults stay below {:.0f} N. {} of {} "
      "random trials do what no fault may do: with 95 % confidence less than {:.2f} % of such "
      "trials. The largest true force of all is {:.0f} N. Without a fault, or before it came, {} "
      "runs were stopped.",
      campaign.cells.size() - static_cast<std::size_t>(failed), campaign.cells.size(), held,
      campaign.pairs.size(), double_fault_n, campaign.violations(), campaign.random.size(),
      100.0 * campaign.violation_bound(), campaign.worst_force_n(), campaign.false_stops);
}

std::string to_json(const Campaign& campaign) {
  const std::vector<double> actions_ms = campaign.first_actions_ms();
  const auto held = std::count_if(campaign.pairs.begin(), campaign.pairs.end(),
                                  [](const auto& pair) { return pair.holds(); });
  nlohmann::ordered_json json = {{"seed", campaign.order.seed}, {"full", campaign.order.full}};
  json["cells"] = campaign.cells.size();
  json["failed"] = to_json(failed_table(campaign));
  json["double_faults"] = {{"held", held}, {"of", campaign.pairs.size()}};
  json["sessions"] = {{"run", campaign.random.size()},
                      {"violations", campaign.violations()},
                      {"bound", campaign.violation_bound()}};
  json["worst_force_n"] = campaign.worst_force_n();
  json["first_action_ms"] = {{"median", nullptr}, {"max", nullptr}};
  if (!actions_ms.empty())
    json["first_action_ms"] = {{"median", actions_ms[actions_ms.size() / 2]},
                               {"max", actions_ms.back()}};
  json["false_stops"] = campaign.false_stops;
  json["classes"] = to_json(class_table(campaign));
  json["pairs"] = to_json(pair_table(campaign));
  json["places"] = to_json(site_table(campaign));
  return json.dump(2);
}

std::string to_text(const Campaign& campaign) {
  return summary_of(campaign) + " Simulation only.\n\n" + to_text(class_table(campaign)) + "\n" +
         to_text(pair_table(campaign)) + "\n" + to_text(failed_table(campaign));
}

}  // namespace tuina::app
