// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/campaign_plans.hpp"

#include <algorithm>
#include <cmath>

#include "apps/evaluation/safety/judge.hpp"

namespace tuina::app {
namespace {

/// The places at which a stage of the table is tried. In contact these are all five of a medium
/// person who sits, the three tissues of the others, and three of a person who lies; the other
/// stages are tried over hard muscle in both positions.
bool is_tried(const Site& site, Stage stage, bool full) {
  const bool low = site.spot == "low" || site.spot == "midline";
  const bool medium = site.body_type == sim::BodyType::medium;
  if (full) return true;
  if (stage != Stage::contact) return medium && site.spot == "hard";
  return site.position == BodyPosture::sitting ? medium || !low : medium && site.spot != "low";
}

const Site& site_at(const std::vector<Site>& sites, BodyPosture position, const char* spot,
                    Arm arm) {
  return *std::find_if(sites.begin(), sites.end(), [&](const Site& site) {
    return site.position == position && site.spot == spot && site.arm == arm &&
           site.body_type == sim::BodyType::medium;
  });
}

}  // namespace

std::vector<FaultPair> fault_pairs() {
  const std::vector<const char*> names = {"wrist drops out", "wrist stuck",       "encoder frozen",
                                          "stall of 50 ms",  "controller killed", "sits up",
                                          "ten times harder"};
  std::vector<FaultPair> pairs;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t k = i + 1; k < names.size(); ++k)
      pairs.push_back({.first = &fault_class(names[i]), .second = &fault_class(names[k])});
  }
  return pairs;
}

/// Every order and distance of a pair at every place.
std::vector<TrialPlan> plans_of(const FaultPair& pair, const std::vector<Site>& sites,
                                const CampaignOrder& order) {
  std::vector<double> apart_s = {0.0, 0.02, -0.02};
  if (order.full) apart_s.insert(apart_s.end(), {0.005, 0.1, 0.5, -0.005, -0.1, -0.5});
  std::vector<TrialPlan> plans;
  for (const double later_s : apart_s) {
    for (const char* spot : {"bone", "hard", "low"}) {
      const Arm arm = plans.size() % 2 == 0 ? Arm::left : Arm::right;
      plans.push_back({.site = &site_at(sites, BodyPosture::sitting, spot, arm),
                       .stage = Stage::contact,
                       .into_stage_s = usual_time_s(Stage::contact),
                       .onsets = {{.fault = pair.first, .later_s = std::max(0.0, -later_s)},
                                  {.fault = pair.second, .later_s = std::max(0.0, later_s)}},
                       .seed = order.seed + plans.size()});
    }
  }
  return plans;
}

/// A random fault at a random moment of a random contact.
TrialPlan random_plan(const std::vector<Site>& sites, std::uint64_t seed) {
  Random random = make_random(seed, "random fault");
  TrialPlan plan =
      trial_of(fault_classes()[random() % fault_classes().size()], sites, any_choices(random));
  plan.whole = true;
  plan.seed = seed;
  return plan;
}

CampaignOrder campaign_order(bool full, const std::string& only, std::uint64_t seed,
                             const session::Config& config) {
  CampaignOrder order{.full = full, .seed = seed, .config = config, .only = only};
  // Ten clean sessions of twenty minutes, as long as a massage of one region may last.
  if (full) order.random_trials = 3000, order.clean_sessions = 10, order.people = 300;
  if (!only.empty()) order.random_trials = order.clean_runs = 0;
  return order;
}

std::vector<CampaignCell> campaign_cells(const std::vector<Site>& sites, bool full,
                                         std::uint64_t seed) {
  std::vector<CampaignCell> cells;
  for (const FaultClass& fault : fault_classes()) {
    for (const Stage stage : fault.stages) {
      for (const Site& site : sites) {
        if (!is_tried(site, stage, full)) continue;
        // In contact either arm has every second place, one after the other.
        const std::size_t place = static_cast<std::size_t>(&site - sites.data()) / 2;
        const Arm turn =
            (place + static_cast<std::size_t>(fault.number)) % 2 == 0 ? Arm::left : Arm::right;
        if (!full && stage == Stage::contact && site.arm != turn) continue;
        cells.push_back({.fault = &fault,
                         .plan = {.site = &site,
                                  .stage = stage,
                                  .into_stage_s = fault.whole ? 0.0 : usual_time_s(stage),
                                  .onsets = {{.fault = &fault}},
                                  .whole = fault.whole,
                                  .watched_s = fault.watched_s,
                                  .seed = seed + cells.size()},
                         .outcome = {}});
      }
    }
  }
  return cells;
}

std::size_t Campaign::false_stops() const {
  const auto count = [](const auto& list, const auto& stopped) {
    return static_cast<std::size_t>(std::count_if(list.begin(), list.end(), stopped));
  };
  std::size_t of_pairs = 0;
  for (const FaultPair& pair : pairs) of_pairs += pair.stopped_before;
  return of_pairs + count(cells, [](const CampaignCell& one) { return !one.outcome.tried; }) +
         count(random, [](const RandomTrial& one) { return !one.outcome.tried; }) +
         count(clean, [](const TrialOutcome& one) { return one.stopped; }) +
         count(clean_sessions, [](const CleanSession& one) { return !one.stops.empty(); }) +
         count(people, [](const PersonRun& one) { return one.outcome.by_guard; });
}

std::size_t Campaign::violations() const {
  return static_cast<std::size_t>(std::count_if(
      random.begin(), random.end(), [](const RandomTrial& trial) { return trial.violates(); }));
}

double Campaign::violation_bound() const {
  return clopper_pearson_upper(violations(), random.size());
}

double Campaign::worst_force_n() const {
  double worst_n = 0.0;
  for (const CampaignCell& cell : cells) worst_n = std::max(worst_n, cell.outcome.worst_force_n);
  for (const FaultPair& pair : pairs) worst_n = std::max(worst_n, pair.worst_force_n);
  for (const RandomTrial& trial : random) worst_n = std::max(worst_n, trial.outcome.worst_force_n);
  for (const WorstTrial& trial : worst) worst_n = std::max(worst_n, trial.worst_force_n);
  return worst_n;
}

std::vector<double> Campaign::first_actions_ms() const {
  std::vector<double> actions_ms;
  for (const CampaignCell& cell : cells) {
    if (cell.fault->promise.duty == Duty::stop && !std::isnan(cell.outcome.first_action_ms))
      actions_ms.push_back(cell.outcome.first_action_ms);
  }
  std::sort(actions_ms.begin(), actions_ms.end());
  return actions_ms;
}

}  // namespace tuina::app
