// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// One sample of a record.
struct TimedPress {
  double time_s = 0.0;
  Press press;
};

/// Standard deviations of single samples.
struct SensorNoise {
  double force_n = 0.2;
  double position_m = 0.05e-3;
};

/// What the caller knows of the noise; NaN: nothing.
struct KnownNoise {
  double force_n = std::numeric_limits<double>::quiet_NaN();
  double position_m = std::numeric_limits<double>::quiet_NaN();

  /// As known, else as in `otherwise`.
  [[nodiscard]] SensorNoise over(SensorNoise otherwise) const;
};

/// What is wrong with a row of a record, in one sentence: a time that does not grow over that of
/// the row `before` (null: the first one), or more than 1000 mm or 10000 N. Empty: nothing.
[[nodiscard]] std::string fault_of(const TimedPress& row, const TimedPress* before);

/// What is wrong with a whole record, in one sentence: metres, grams or milliseconds, or positions
/// that fall as the tool goes deeper, or both signs turned. Empty: nothing.
[[nodiscard]] std::string fault_of(std::span<const TimedPress> record);
/// What is wrong with the positions of a press that is to be foretold from a record; empty:
/// nothing.
[[nodiscard]] std::string fault_of_next(std::span<const TimedPress> record,
                                        std::span<const TimedPress> next);

/// Estimates sensor noise from a record: deviation of each sample from the straight line between
/// its neighbours, robust against presses and dropouts. Needs no free air. Slow (coloured) errors
/// are invisible to it.
[[nodiscard]] SensorNoise estimate_noise(std::span<const TimedPress> record);

/// Removes samples at the end of the force sensor's range, or so close below it that noise decided.
[[nodiscard]] std::vector<TimedPress> without_saturation(std::span<const TimedPress> record,
                                                         const SensorNoise& noise);

}  // namespace tuina::tissue
