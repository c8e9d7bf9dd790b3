// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/late_force.hpp"

#include <algorithm>

namespace tuina::control {
namespace {

// An integral alone would ring at 1.6 / lag; beside the damping of contact it must be far slower.
constexpr double trim_share = 0.06;
// Lags for which a speed must last to count as the skin's: sooner, it is the loop's own.
constexpr double carried_lags = 12.0;
constexpr double late_contact_damping_ratio = 1.2;
constexpr double max_late_damping_n_s_per_m = 3000.0;

}  // namespace

ArmController::Options for_late_force(ArmController::Options options, double lag_s) noexcept {
  if (!(lag_s > 0.0)) return options;
  ForceTarget::Options& force = options.force;
  force.sensor_lag_s += lag_s;
  force.trim_per_s = std::min(force.trim_per_s, trim_share / force.sensor_lag_s);
  force.carried_after_s = std::max(force.carried_after_s, carried_lags * force.sensor_lag_s);
  force.contact_damping_ratio = std::max(force.contact_damping_ratio, late_contact_damping_ratio);
  force.max_damping_n_s_per_m = std::max(force.max_damping_n_s_per_m, max_late_damping_n_s_per_m);
  return options;
}

}  // namespace tuina::control
