// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/escape.hpp"

#include <algorithm>

namespace tuina::control {

void Escape::begin(double force_n) noexcept {
  last_forces_n_.fill(force_n);
  startled_ = pushing_ = false;
}

bool Escape::step(double force_n, const Expected& expected, double dt_s) noexcept {
  // The slope over three ticks; over one it would be noise.
  const double rate_n_per_s = (force_n - last_forces_n_.back()) / (3.0 * dt_s);
  last_forces_n_ = {force_n, last_forces_n_[0], last_forces_n_[1]};
  const double foreseen_n =
      force_n + options_.startle_ahead_s * (rate_n_per_s - expected.rate_n_per_s);
  if (!startled_ && force_n > options_.min_felt_n &&
      foreseen_n > expected.force_n + options_.startle_n)
    startled_ = pushing_ = true;
  if (!pushing_) return false;
  pushing_ = force_n + options_.sensor_lag_s * rate_n_per_s >= options_.kept_n;
  return true;
}

double Escape::push_n(double outward_m_per_s) const noexcept {
  const double left = (options_.max_m_per_s - outward_m_per_s) /
                      (options_.max_m_per_s - options_.full_push_m_per_s);
  return options_.push_out_n * std::clamp(left, 0.0, 1.0);
}

}  // namespace tuina::control
