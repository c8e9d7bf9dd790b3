// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/simulated/simulated_session.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

class Cells;

/// One whole session that shall be judged.
struct SessionTrial {
  SessionOrder order;
  std::uint64_t seed = 1;
};

/// Tissue as felt in one contact, beside the first loading of the true one.
struct FeltTrial {
  bool converged = false;
  /// Logarithms of felt over true, and how far the 95 % interval reaches.
  double alpha_error = 0.0, alpha_reach = 0.0, beta_error = 0.0, beta_reach = 0.0;
};

/// What became of it, judged by what only the simulation knows.
struct SessionOutcome {
  std::string refused = {};  ///< why there was no session; the rest is then empty
  BodyPosture position = BodyPosture::sitting;
  std::vector<std::string> stops = {}, troubles = {}, left_out = {};
  std::vector<std::string> beyond =
      {};  ///< force beyond a true zone's cap, press far off its point, press not as planned
  double duration_s = 0.0;
  double rmse_n = 0.0, overshoot_n = 0.0;  ///< errors of the true force, all techniques
  double bony_peak_n = 0.0;                ///< largest force where bone truly is near
  /// Largest excess over the true zone's cap, and over the force that trips the guard there.
  double over_cap_n = -std::numeric_limits<double>::infinity();
  double over_trip_n = -std::numeric_limits<double>::infinity();
  double unplanned_n = 0.0;     ///< largest force outside planned contacts
  double arm_distance_m = 0.0;  ///< smallest
  std::vector<double> tool_to_acupoint_m =
      {};  ///< distance of each press of one of the seven points
  std::vector<GivenPress> presses = {};
  std::vector<FeltTrial> felt = {};
  double scan_to_touch_s = 0.0;
  double plan_ms = 0.0;
  double real_time_factor = 0.0;
};

/// Given as ordered: the largest true force of a press is this share of the plan.
inline constexpr double min_given = 0.95, max_given = 1.02;

[[nodiscard]] SessionOutcome run_session_trial(const SessionTrial& trial,
                                               const session::Config& config);

/// Side by side on all cores; the outcomes, in the order of the trials, do not depend on how many
/// there are. Each trial is a cell.
[[nodiscard]] Result<std::vector<SessionOutcome>> run_session_trials(
    const std::vector<SessionTrial>& trials, const session::Config& config, Cells& cells,
    const Progress& progress);

/// Many sessions in one row of a table.
struct SessionSummary {
  std::size_t sessions = 0, refused = 0, stopped = 0, troubled = 0, paths_left_out = 0;
  double worst_rmse_n = 0.0, mean_rmse_n = 0.0, worst_overshoot_n = 0.0;
  double max_over_cap_n = 0.0, max_over_trip_n = 0.0, max_unplanned_n = 0.0, bony_peak_n = 0.0;
  double min_arm_distance_m = 0.0;
  double mean_tool_to_acupoint_m = 0.0, max_tool_to_acupoint_m = 0.0;
  double worst_scan_to_touch_s = 0.0, worst_plan_ms = 0.0;
  double mean_duration_s = 0.0, median_real_time_factor = 0.0;
};
[[nodiscard]] SessionSummary summarise(const std::vector<const SessionOutcome*>& outcomes);

}  // namespace tuina::app
