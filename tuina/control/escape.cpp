// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/escape.hpp"

namespace tuina::control {

void Escape::begin(double force_n) noexcept {
  last_forces_n_.fill(force_n);
  startled_ = pushing_ = false;
}

bool Escape::step(double force_n, double expected_n, double dt_s) noexcept {
  // The slope over three ticks; over one it would be noise.
  const double rate_n_per_s = (force_n - last_forces_n_.back()) / (3.0 * dt_s);
  last_forces_n_ = {force_n, last_forces_n_[0], last_forces_n_[1]};
  const double foreseen_n = force_n + options_.startle_ahead_s * rate_n_per_s;
  if (!startled_ && foreseen_n > expected_n + options_.startle_n) startled_ = pushing_ = true;
  if (!pushing_) return false;
  pushing_ = force_n + options_.sensor_lag_s * rate_n_per_s >= options_.kept_n;
  return true;
}

}  // namespace tuina::control
