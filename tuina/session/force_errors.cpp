// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/force_errors.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::session {

void ForceErrorSum::add(double time_s, double target_n, double true_force_n) noexcept {
  constexpr double settling_s = 0.3;
  const double error_n = target_n - true_force_n;
  if (target_n != previous_target_n_) changed_s_ = time_s;
  previous_target_n_ = target_n;
  squares_ += error_n * error_n;
  ++samples_;
  if (time_s - changed_s_ >= settling_s) {
    settled_squares_ += error_n * error_n;
    ++settled_samples_;
  }
  peak_n_ = std::max(peak_n_, true_force_n);
  overshoot_n_ = std::max(overshoot_n_, -error_n);
}

ForceErrors ForceErrorSum::errors() const noexcept {
  ForceErrors errors{.peak_n = peak_n_, .overshoot_n = overshoot_n_, .settled_rmse_n = {}};
  if (samples_ > 0) errors.rmse_n = std::sqrt(squares_ / static_cast<double>(samples_));
  if (settled_samples_ > 0) {
    errors.settled_rmse_n = std::sqrt(settled_squares_ / static_cast<double>(settled_samples_));
  }
  return errors;
}

}  // namespace tuina::session
