// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace tuina::sim {

/// One axis of a force sensor that drifts, and whose reading lags behind by half of a share of the
/// strongest it has felt.
struct SensorAxis {
  double drift_per_s = 0.0;
  double hysteresis = 0.0;  ///< share of the strongest
  double held = 0.0, strongest = 0.0;

  /// What is read of a force or torque, without drift.
  double lag(double felt) noexcept {
    strongest = std::max(strongest, std::abs(felt));
    const double play = 0.5 * hysteresis * strongest;
    return held = std::clamp(held, felt - play, felt + play);
  }
};

}  // namespace tuina::sim
