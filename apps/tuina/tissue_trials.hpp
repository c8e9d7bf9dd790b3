// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/progress.hpp"
#include "tuina/sim/press_scenarios.hpp"

namespace tuina::app {

/// The three tissues of [thesis] Table 6-1 and the forces they are pressed with.
struct TrialTissue {
  const char* name;
  TangentTissue tissue;
  double peak_n, robot_peak_n;
};
inline constexpr std::array<TrialTissue, 3> trial_tissues = {
    {{"bone", {4.559, 263.2}, 30.0, 25.0},
     {"hard", {9.786, 185.4}, 60.0, 30.0},
     {"soft", {4.275, 143.6}, 60.0, 25.0}}};

enum class TrialMethod : std::uint8_t { tuina, thesis, thesis_held, batch };
inline constexpr std::array<TrialMethod, 4> trial_methods = {
    TrialMethod::tuina, TrialMethod::thesis, TrialMethod::thesis_held, TrialMethod::batch};
[[nodiscard]] const char* name_of(TrialMethod method) noexcept;

/// Many runs of one method on one tissue in one scenario. Errors are relative; `worse` is the
/// larger one of alpha and beta. What a method does not have (a batch fit no time, the thesis no
/// interval) is NaN.
struct TrialResult {
  int runs = 0;
  double t95_s = 0.0;            ///< from then on 95 % of the runs stay within 5 %
  double first_press_q95 = 0.0;  ///< 95 % quantile of the worse error after one press
  double last_q95 = 0.0;         ///< the same at the end
  double alpha_bias = 0.0;
  double coverage_alpha = 0.0, coverage_beta = 0.0;        ///< of the 95 % intervals, at the end
  double converged_share = 0.0, converged_median_s = 0.0;  ///< from the first contact
  double false_converged_share = 0.0;  ///< of all runs: called converged while beyond the promise
  double detectable_change = 0.0;  ///< of alpha between two such records, 2.77 standard deviations
};

/// Same seed, same result, whatever the number of threads.
[[nodiscard]] TrialResult run_trials(const sim::PressScenario& scenario, const TrialTissue& tissue,
                                     TrialMethod method, int runs, std::uint64_t seed,
                                     unsigned threads);

}  // namespace tuina::app
