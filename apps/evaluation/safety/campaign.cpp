// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/campaign.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>

#include "apps/evaluation/safety/judge.hpp"
#include "tuina/core/parallel.hpp"

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
  const auto any = [&](const auto& list) -> const auto& {
    return list[random() % list.size()];
  };
  const FaultClass& fault = any(fault_classes());
  constexpr std::array longest_s = {0.12, 0.6, 0.8, 1.5, 0.3};
  const Stage stage = any(fault.stages);
  const double until_s = longest_s[static_cast<std::size_t>(stage)];
  TrialPlan plan{.site = &any(sites),
                 .stage = stage,
                 .into_stage_s = uniform(random, 0.0, until_s),
                 .onsets = {{.fault = &fault, .severity = uniform(random, 0.3, 1.0)}},
                 .whole = true,
                 .seed = seed};
  // Twice as hard and twice as soft as anybody of Table 6-2; beta is a thickness and varies less.
  plan.alpha_scale = uniform(random, 0.5, 2.0);
  plan.beta_scale = uniform(random, 0.7, 1.4);
  return plan;
}

/// Runs trials side by side and keeps the first failure.
class Runs {
 public:
  Runs(std::size_t total, const Progress& progress) : total_(total), progress_(progress) {}

  template <class Work>
  [[nodiscard]] Result<void> each(std::size_t count, const Work& work) {
    std::mutex guard;
    std::optional<Error> failure;
    for_each_in_parallel(
        count,
        [&](std::size_t k) {
          const Result<void> done = work(k);
          const std::lock_guard lock(guard);
          if (!done && !failure) failure = done.error();
        },
        [&](double share) {
          if (progress_)
            progress_((static_cast<double>(done_) + share * static_cast<double>(count)) /
                      static_cast<double>(total_));
        });
    done_ += count;
    if (failure) return tl::unexpected(*failure);
    return {};
  }

 private:
  std::size_t total_, done_ = 0;
  const Progress& progress_;
};

Result<void> run_pairs(Campaign& campaign, Runs& runs) {
  struct Job {
    FaultPair* pair;
    TrialPlan plan;
    double worst_force_n = 0.0;
  };
  std::vector<Job> jobs;
  for (FaultPair& pair : campaign.pairs) {
    for (TrialPlan& plan : plans_of(pair, campaign.sites, campaign.order))
      jobs.push_back({&pair, std::move(plan)});
  }
  const auto done = runs.each(jobs.size(), [&](std::size_t k) -> Result<void> {
    const auto outcome = run_trial(jobs[k].plan);
    if (!outcome) return tl::unexpected(outcome.error());
    jobs[k].worst_force_n = outcome->worst_force_n;
    return {};
  });
  for (Job& job : jobs) {
    if (job.worst_force_n < job.pair->worst_force_n) continue;
    job.pair->worst_force_n = job.worst_force_n;
    job.pair->worst_plan = std::move(job.plan);
  }
  return done;
}

Result<void> run_random(Campaign& campaign, Runs& runs) {
  campaign.random.resize(campaign.order.random_trials);
  return runs.each(campaign.random.size(), [&](std::size_t k) -> Result<void> {
    RandomTrial& trial = campaign.random[k];
    trial.plan = random_plan(campaign.sites, 1000 * campaign.order.seed + k);
    auto outcome = run_trial(trial.plan);
    if (!outcome) return tl::unexpected(outcome.error());
    trial.outcome = std::move(*outcome);
    return {};
  });
}

Result<void> run_clean(Campaign& campaign, Runs& runs) {
  std::vector<TrialOutcome> outcomes(campaign.order.clean_runs);
  const auto done = runs.each(outcomes.size(), [&](std::size_t k) -> Result<void> {
    auto outcome = run_trial({.site = &campaign.sites[(7 * k) % campaign.sites.size()],
                              .whole = true,
                              .press_s = campaign.order.clean_press_s,
                              .seed = campaign.order.seed + k});
    if (!outcome) return tl::unexpected(outcome.error());
    outcomes[k] = std::move(*outcome);
    return {};
  });
  for (const TrialOutcome& outcome : outcomes) campaign.false_stops += outcome.stopped ? 1 : 0;
  for (const CampaignCell& cell : campaign.cells)
    campaign.false_stops += cell.outcome.tried ? 0 : 1;
  for (const RandomTrial& trial : campaign.random)
    campaign.false_stops += trial.outcome.tried ? 0 : 1;
  return done;
}

}  // namespace

CampaignOrder campaign_order(bool full, const std::string& only, std::uint64_t seed) {
  CampaignOrder order{.full = full, .seed = seed, .only = only};
  // Ten clean runs of twenty minutes, as long as a massage of one region may last.
  if (full) order.random_trials = 3000, order.clean_press_s = 1200.0;
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
                                  .into_stage_s = usual_time_s(stage),
                                  .onsets = {{.fault = &fault}},
                                  .watched_s = fault.watched_s,
                                  .seed = seed + cells.size()},
                         .outcome = {}});
      }
    }
  }
  return cells;
}

Result<void> run_cell(CampaignCell& cell) {
  auto outcome = run_trial(cell.plan);
  if (!outcome) return tl::unexpected(outcome.error());
  cell.outcome = std::move(*outcome);
  cell.broken = broken_promises(*cell.fault, cell.plan.stage, cell.outcome);
  return {};
}

Result<Campaign> run_campaign(const CampaignOrder& order, const Progress& progress) {
  auto sites = make_sites(order.seed);
  if (!sites) return tl::unexpected(sites.error());
  Campaign campaign{.order = order, .sites = std::move(*sites)};
  campaign.cells = campaign_cells(campaign.sites, order.full, order.seed);
  if (order.only.empty()) {
    campaign.pairs = fault_pairs();
  } else {
    std::erase_if(campaign.cells, [&](const auto& cell) { return cell.fault->name != order.only; });
  }
  const std::size_t pair_trials =
      campaign.pairs.size() * plans_of(fault_pairs().front(), campaign.sites, order).size();
  Runs runs(campaign.cells.size() + pair_trials + order.random_trials + order.clean_runs, progress);
  const auto cell = [&](std::size_t k) { return run_cell(campaign.cells[k]); };
  if (auto done = runs.each(campaign.cells.size(), cell); !done)
    return tl::unexpected(done.error());
  for (const auto part : {run_pairs, run_random, run_clean}) {
    if (auto done = part(campaign, runs); !done) return tl::unexpected(done.error());
  }
  return campaign;
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
