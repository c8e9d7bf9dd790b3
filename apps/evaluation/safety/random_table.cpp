// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/evaluation/safety/report.hpp"

namespace tuina::app {

telemetry::Table random_table(const Campaign& campaign) {
  telemetry::Table table{.title = "Random trials that do what none may do",
                         .columns = {{.head = "trial", .key = "seed"},
                                     {.head = "fault", .key = "fault"},
                                     {.head = "in", .key = "stage"},
                                     {.head = "place", .key = "place"},
                                     {.head = "force, N", .key = "worst_force_n", .digits = 0},
                                     {.head = "above 60 N, ms", .key = "over_60_n_ms", .digits = 0},
                                     {.head = "acts, ms", .key = "first_action_ms", .digits = 0},
                                     {.head = "end", .key = "end"},
                                     {.head = "cause", .key = "cause"}}};
  for (const RandomTrial& trial : campaign.random) {
    const TrialOutcome& outcome = trial.outcome;
    if (!trial.violates() && outcome.tried) continue;
    const TrialPlan& plan = trial.plan;
    table.add({fmt::format("{}", plan.seed),
               outcome.tried ? plan.onsets.front().fault->name : "none: stopped before it came",
               name_of(plan.stage), plan.site->name, outcome.worst_force_n,
               1e3 * outcome.over_seldom_s, outcome.first_action_ms, outcome.end, outcome.cause});
  }
  return table;
}

}  // namespace tuina::app
