// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

struct TimedPress {
  double time_s = 0.0;
  Press press;
};

/// Standard deviations of single samples.
struct SensorNoise {
  double force_n = 0.2;
  double position_m = 0.05e-3;
};

/// Estimates sensor noise from a record: deviation of each sample from the straight line between
/// its neighbours, robust against presses and dropouts. Needs no free air. Slow (coloured) errors
/// are invisible to it.
[[nodiscard]] SensorNoise estimate_noise(std::span<const TimedPress> record);

/// Removes samples at the end of the force sensor's range, or so close below it that noise decided.
[[nodiscard]] std::vector<TimedPress> without_saturation(std::span<const TimedPress> record,
                                                         const SensorNoise& noise);

}  // namespace tuina::tissue
