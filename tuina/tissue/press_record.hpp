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

/// What the sensors add, read from the record itself: each sample against the straight line between
/// its neighbours, the middle value of all, so presses and dropouts do not count. Needs no free
/// air. Slowly varying (coloured) errors stay unseen.
[[nodiscard]] SensorNoise estimate_noise(std::span<const TimedPress> record);

/// The record without the samples in which the force sensor stood at the end of its range, or so
/// close below it that noise decided which of them did.
[[nodiscard]] std::vector<TimedPress> without_saturation(std::span<const TimedPress> record,
                                                         const SensorNoise& noise);

}  // namespace tuina::tissue
