// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "tuina/core/result.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::scanner {

/// Maximum time for which the laser is lit without a new picture and without a turn of the unit.
inline constexpr double max_blind_s = 0.15;

/// Watches one turn of the unit frame by frame, so that a beam that stands or that nobody sees goes
/// out. Times of frames are the camera's, times of readings the motor's.
class ScanWatch {
 public:
  /// `rad_per_s`: the ordered speed. Below 6 degrees per second the motor's counts are farther
  /// apart, and the unit may seem to stand for the time of three of them.
  ScanWatch(double rad_per_s, double latency_s);

  /// Once per frame, with all readings so far. Fault::device, with the cause, when every picture
  /// for `max_blind_s` was the same, or when the motor stood or gave no readings for as long.
  [[nodiscard]] Result<void> see(double frame_s, bool new_picture,
                                 std::span<const YawReading> readings);

 private:
  double patience_s_;
  double latency_s_;
  std::optional<double> first_s_;
  double new_picture_s_ = 0.0;
};

}  // namespace tuina::scanner
