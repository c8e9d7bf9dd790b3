// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/technique/press.hpp"
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

/// `thesis` is as printed; `thesis_tuned` holds still in the air and is told where the skin is,
/// which no one can know; `kalman` is the usual extended filter in force; `batch` fits the whole
/// record.
enum class TrialMethod : std::uint8_t { tuina, thesis, thesis_tuned, kalman, batch };
inline constexpr std::array<TrialMethod, 5> trial_methods = {
    TrialMethod::tuina, TrialMethod::thesis, TrialMethod::thesis_tuned, TrialMethod::kalman,
    TrialMethod::batch};
[[nodiscard]] const char* name_of(TrialMethod method) noexcept;

/// Many runs of one method on one tissue in one scenario. Errors are relative; `worse` is the
/// larger one of alpha and beta. What a method does not have (a batch fit no time, the thesis no
/// interval) is NaN.
struct TrialResult {
  int runs = 0;
  double t95_s = 0.0;            ///< time from which 95 % of the runs stay within 5 %
  double first_press_q95 = 0.0;  ///< 95 % quantile of the worse error after one press
  double last_q95 = 0.0;         ///< the same at the end
  double alpha_bias = 0.0, beta_bias = 0.0;
  double coverage_alpha = 0.0,
         coverage_beta = 0.0;  ///< share of the 95 % intervals that hold the truth, at the end
  double converged_share = 0.0, converged_median_s = 0.0;  ///< share, and time since first contact
  double false_converged_share =
      0.0;                  ///< share of all runs called converged while beyond the promise
  double kept_share = 0.0;  ///< at the end within what `converged` promises, called so or not
  double detectable_change =
      0.0;  ///< smallest change of alpha between two such records: 2.77 standard deviations
  std::vector<double> worse_q95;  ///< every `curve_step_s` the quantile of the worse error; online
                                  ///< methods only
};
inline constexpr double curve_step_s = 0.05;

/// The value that this share of them does not reach; those that are no numbers are left out.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// All methods on the same records. Same seed, same result, whatever the number of threads.
using TrialResults = std::array<TrialResult, trial_methods.size()>;
[[nodiscard]] TrialResults run_trials(const sim::PressScenario& scenario, const TrialTissue& tissue,
                                      int runs, std::uint64_t seed, unsigned threads,
                                      const Progress& progress = {});

/// Two presses by the simulated arm under control, with its friction, sensors and a body that
/// breathes and gives way: the depth comes from joint angles. Tissue, torso (20 %), skin (3 mm),
/// force (20 to 30 N) and masses differ from run to run.
struct LoopScenario {
  std::string name, about;
  massage::PressWindow window;
  double breath_m = 3e-3, breath_hz = 0.25;
};
[[nodiscard]] const std::vector<LoopScenario>& loop_scenarios();
[[nodiscard]] Result<TrialResults> run_loop_trials(const LoopScenario& scenario,
                                                   const TrialTissue& tissue, int runs,
                                                   std::uint64_t seed, unsigned threads,
                                                   const Progress& progress = {});

}  // namespace tuina::app
