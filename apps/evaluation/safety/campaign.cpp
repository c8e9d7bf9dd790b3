// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/campaign.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <mutex>
#include <optional>

#include "apps/evaluation/safety/campaign_plans.hpp"
#include "apps/evaluation/safety/judge.hpp"
#include "apps/evaluation/safety/outcome_fields.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/core/parallel.hpp"

namespace tuina::app {
namespace {

/// Runs trials side by side and keeps the first failure.
class Runs {
 public:
  Runs(std::size_t total, Cells& cells, const Progress& progress)
      : cells_(cells), total_(total), progress_(progress) {}

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
        of(count));
    done_ += count;
    if (failure) return tl::unexpected(*failure);
    return {};
  }
  /// The progress of so many runs that come next and take care of themselves.
  [[nodiscard]] Progress of(std::size_t count) const {
    return [this, begun = done_, count](double share) {
      if (progress_)
        progress_((static_cast<double>(begun) + share * static_cast<double>(count)) /
                  static_cast<double>(total_));
    };
  }
  void done(std::size_t count) { done_ += count; }

  /// A trial as a cell, by its part of the campaign and its place there.
  [[nodiscard]] Result<TrialOutcome> trial(const char* part, std::size_t k, const TrialPlan& plan) {
    return at<TrialOutcome>(part, k, [&] { return run_trial(plan); });
  }
  template <typename Outcome, typename Compute>
  [[nodiscard]] Result<Outcome> at(const char* part, std::size_t k, const Compute& compute) {
    return cells_.at<Outcome>(fmt::format("{} {}", part, k), compute);
  }

 private:
  Cells& cells_;
  std::size_t total_, done_ = 0;
  const Progress& progress_;
};

Result<void> run_pairs(Campaign& campaign, Runs& runs) {
  struct Job {
    FaultPair* pair;
    TrialPlan plan;
    double worst_force_n = 0.0;
    bool tried = true;
  };
  std::vector<Job> jobs;
  for (FaultPair& pair : campaign.pairs) {
    for (TrialPlan& plan : plans_of(pair, campaign.sites, campaign.order))
      jobs.push_back({&pair, std::move(plan)});
  }
  auto done = runs.each(jobs.size(), [&](std::size_t k) -> Result<void> {
    const auto outcome = runs.trial("pair", k, jobs[k].plan);
    if (!outcome) return tl::unexpected(outcome.error());
    jobs[k].worst_force_n = outcome->worst_force_n;
    jobs[k].tried = outcome->tried;
    return {};
  });
  for (Job& job : jobs) {
    job.pair->stopped_before += job.tried ? 0 : 1;
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
    auto outcome = runs.trial("random", k, trial.plan);
    if (!outcome) return tl::unexpected(outcome.error());
    trial.outcome = std::move(*outcome);
    return {};
  });
}

Result<void> run_clean(Campaign& campaign, Runs& runs) {
  constexpr double press_s = 30.0;
  campaign.clean.resize(campaign.order.clean_runs);
  return runs.each(campaign.clean.size(), [&](std::size_t k) -> Result<void> {
    auto outcome = runs.trial("clean", k,
                              {.site = &campaign.sites[(7 * k) % campaign.sites.size()],
                               .whole = true,
                               .press_s = press_s,
                               .seed = campaign.order.seed + k});
    if (!outcome) return tl::unexpected(outcome.error());
    campaign.clean[k] = std::move(*outcome);
    return {};
  });
}

Result<void> run_clean_sessions(Campaign& campaign, Runs& runs) {
  campaign.clean_sessions.resize(campaign.order.clean_sessions);
  return runs.each(campaign.clean_sessions.size(), [&](std::size_t k) -> Result<void> {
    auto session = runs.at<CleanSession>("clean session", k, [&] {
      return run_clean_session(campaign.order.seed + k, campaign.order.config);
    });
    if (!session) return tl::unexpected(session.error());
    campaign.clean_sessions[k] = std::move(*session);
    return {};
  });
}

Result<void> run_people(Campaign& campaign, Runs& runs) {
  campaign.people.resize(campaign.order.people);
  return runs.each(campaign.people.size(), [&](std::size_t k) -> Result<void> {
    PersonRun& person = campaign.people[k];
    person = draw_person(campaign.sites, 1000 * campaign.order.seed + k);
    auto outcome = runs.trial("person", k, person.plan);
    if (!outcome) return tl::unexpected(outcome.error());
    person.outcome = std::move(*outcome);
    return {};
  });
}

Result<void> run_sessions(Campaign& campaign, Runs& runs) {
  if (!campaign.order.cells || !campaign.order.only.empty()) return {};
  std::size_t number = 0;
  for (const auto part : {run_scan_cells, run_session_cells}) {
    auto cells = runs.at<SessionCells>("sessions", number++, [&]() -> Result<SessionCells> {
      auto made = part(campaign.order.seed, campaign.order.config, runs.of(1));
      if (!made) return tl::unexpected(made.error());
      return SessionCells{std::move(*made)};
    });
    runs.done(1);
    if (!cells) return tl::unexpected(cells.error());
    std::move(cells->all.begin(), cells->all.end(), std::back_inserter(campaign.sessions));
  }
  return {};
}

Result<void> run_search(Campaign& campaign, Runs& runs) {
  const CampaignOrder& order = campaign.order;
  if (order.search_trials == 0) return {};
  auto worst = search_worst(campaign.sites, order.only, order.search_trials, order.seed,
                            runs.of(order.search_trials));
  if (!worst) return tl::unexpected(worst.error());
  campaign.worst = std::move(*worst);
  return {};
}

}  // namespace

namespace {

void judge(CampaignCell& cell, TrialOutcome outcome) {
  cell.outcome = std::move(outcome);
  cell.broken = broken_promises(*cell.fault, cell.plan.stage, cell.outcome);
}

}  // namespace

Result<void> run_cell(CampaignCell& cell) {
  auto outcome = run_trial(cell.plan);
  if (!outcome) return tl::unexpected(outcome.error());
  judge(cell, std::move(*outcome));
  return {};
}

Result<Campaign> run_campaign(const CampaignOrder& order, Cells& cells, const Progress& progress) {
  if (cells.sharded() && order.search_trials > 0)
    return fail(Fault::usage, "--search goes from trial to trial, so it has no shards");
  auto sites = make_sites(order.seed, world_options(order.config));
  if (!sites) return tl::unexpected(sites.error());
  Campaign campaign{.order = order, .sites = std::move(*sites)};
  if (order.cells) campaign.cells = campaign_cells(campaign.sites, order.full, order.seed);
  if (order.pairs && order.only.empty()) campaign.pairs = fault_pairs();
  if (!order.only.empty())
    std::erase_if(campaign.cells, [&](const auto& cell) { return cell.fault->name != order.only; });
  const std::size_t pair_trials =
      campaign.pairs.size() * plans_of(fault_pairs().front(), campaign.sites, order).size();
  constexpr std::size_t session_parts = 2;
  Runs runs(campaign.cells.size() + pair_trials + session_parts + order.random_trials +
                order.clean_runs + order.clean_sessions + order.people + order.search_trials,
            cells, progress);
  const auto cell = [&](std::size_t k) -> Result<void> {
    auto outcome = runs.trial("cell", k, campaign.cells[k].plan);
    if (!outcome) return tl::unexpected(outcome.error());
    judge(campaign.cells[k], std::move(*outcome));
    return {};
  };
  if (auto done = runs.each(campaign.cells.size(), cell); !done)
    return tl::unexpected(done.error());
  for (const auto part : {run_pairs, run_sessions, run_random, run_clean, run_clean_sessions,
                          run_people, run_search}) {
    if (auto done = part(campaign, runs); !done) return tl::unexpected(done.error());
  }
  return campaign;
}

}  // namespace tuina::app
