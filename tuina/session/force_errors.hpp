// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

namespace tuina::session {

/// How well a contact force was held: target minus TRUE force, over a technique with its ramps.
struct ForceErrors {
  double rmse_n = std::numeric_limits<double>::quiet_NaN();  ///< NaN where nothing was touched
  double peak_n = 0.0;                                       ///< largest true force
  double overshoot_n = 0.0;  ///< largest excess of the true force over the target, not below zero
  std::optional<double>
      settled_rmse_n;  ///< RMS error without the 0.3 s after each change of target
};

/// Adds up samples of one technique, in time order; a technique lasts from the first to the last
/// sample with a target above zero, which the caller decides.
class ForceErrorSum {
 public:
  /// Takes a sample, in the order of time.
  void add(double time_s, double target_n, double true_force_n) noexcept;
  /// The next sample starts a technique, which is a change of target from none.
  void begin() noexcept { previous_target_n_ = -1.0; }
  /// Whether no sample has counted.
  [[nodiscard]] bool empty() const noexcept { return samples_ == 0; }
  /// Errors of all samples so far.
  [[nodiscard]] ForceErrors errors() const noexcept;

 private:
  double squares_ = 0.0;
  double settled_squares_ = 0.0;
  long samples_ = 0;
  long settled_samples_ = 0;
  double peak_n_ = 0.0;
  double overshoot_n_ = 0.0;
  double previous_target_n_ = -1.0;
  double changed_s_ = 0.0;
};

}  // namespace tuina::session
