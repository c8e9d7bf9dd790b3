// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/sweep.hpp"

namespace tuina::scanner {

/// Lower than this over the couch nothing breathes: it is the couch, or as good as.
inline constexpr double breathing_from_m = 0.03;

/// The first line of the way back, when the unit turned forth and back over the same scene.
[[nodiscard]] std::optional<std::size_t> turning_point(std::span<const TimedLine> lines,
                                                       std::span<const double> yaw_rad);

struct TwoWay {
  WaysCompared compared;
  std::vector<double> breath_at_m;  ///< per line, towards the scanner from where it is smallest
};

/// The same angle seen at two times: what differs is the clock of the motor, which shifts both ways
/// against each other across the line of sight, and the person's breath, which shifts them along
/// it. Latency by robust least squares, breath as one sine over time. Yaw with the latency of the
/// calibration.
[[nodiscard]] TwoWay compare_ways(std::span<const TimedLine> lines, std::span<const double> yaw_rad,
                                  std::size_t turn, const ScannerCalibration& calibration);

}  // namespace tuina::scanner
