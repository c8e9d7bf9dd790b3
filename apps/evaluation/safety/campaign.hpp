// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/safety/search.hpp"
#include "apps/evaluation/safety/sessions.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// One class in one state at one place: its trial, what came of it and every promise that it broke.
struct CampaignCell {
  const FaultClass* fault = nullptr;
  TrialPlan plan;
  TrialOutcome outcome;
  std::vector<std::string> broken = {};  ///< sentences for people; none: it holds
  [[nodiscard]] bool holds() const { return broken.empty(); }
};

/// Two faults of different classes, with every distance in time and at every place that is tried.
struct FaultPair {
  const FaultClass *first = nullptr, *second = nullptr;
  double worst_force_n = 0.0;
  TrialPlan worst_plan = {};
  std::size_t stopped_before = 0;  ///< trials that were stopped before a fault came
  [[nodiscard]] bool holds() const { return worst_force_n <= double_fault_n; }
};

/// One random trial; a violation is what no fault may ever do.
struct RandomTrial {
  TrialPlan plan;
  TrialOutcome outcome;
  [[nodiscard]] bool violates() const {
    return outcome.worst_force_n > never_n || outcome.over_seldom_s > seldom_s + 1e-9;
  }
};

/// How many of each; a campaign may be made in parts, with other seeds.
struct CampaignOrder {
  bool full = false;
  std::uint64_t seed = 1;
  session::Config config = {};  ///< what the world of all of it is like
  std::string only = {};        ///< the cells or the search of this class, and nothing else
  bool cells = true;            ///< those of the table, scans and sessions
  bool pairs = true;            ///< of faults
  std::size_t random_trials = 300;
  std::size_t clean_runs = 10;  ///< presses of half a minute
  std::size_t clean_sessions = 0, people = 0;
  std::size_t search_trials = 0;  ///< of each class
};
[[nodiscard]] CampaignOrder campaign_order(bool full, const std::string& only, std::uint64_t seed,
                                           const session::Config& config);

struct Campaign {
  CampaignOrder order;
  std::vector<Site> sites;
  std::vector<CampaignCell> cells;
  std::vector<FaultPair> pairs;
  std::vector<SessionCell> sessions;  ///< scans too
  std::vector<RandomTrial> random;
  std::vector<TrialOutcome> clean;
  std::vector<CleanSession> clean_sessions;
  std::vector<PersonRun> people;
  std::vector<WorstTrial> worst;

  /// Of runs without a fault, of others before it came, and of people who breathe or shift.
  [[nodiscard]] std::size_t false_stops() const;

  [[nodiscard]] std::size_t violations() const;
  [[nodiscard]] double violation_bound() const;  ///< 95 %, of a random trial
  [[nodiscard]] double worst_force_n() const;
  /// Of the cells that had to stop and did, in order.
  [[nodiscard]] std::vector<double> first_actions_ms() const;
};

/// Every cell of the table, not yet run; `sites` must outlive them.
[[nodiscard]] std::vector<CampaignCell> campaign_cells(const std::vector<Site>& sites, bool full,
                                                       std::uint64_t seed);
/// Runs a cell and judges it.
[[nodiscard]] Result<void> run_cell(CampaignCell& cell);

/// All of it, side by side on all cores; the results do not depend on how many there are. Every
/// trial is one of `cells`.
[[nodiscard]] Result<Campaign> run_campaign(const CampaignOrder& order, Cells& cells,
                                            const Progress& progress);

}  // namespace tuina::app
