// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/sweep.hpp"

namespace tuina::scanner {

/// Maximum height over the couch of what does not breathe.
inline constexpr double breathing_from_m = 0.03;

/// Index of the first line of the way back, if the unit turned forth and back.
[[nodiscard]] std::optional<std::size_t> turning_point(std::span<const TimedLine> lines,
                                                       std::span<const double> yaw_rad);

/// What forth and back have told of latency and breath.
struct TwoWay {
  WaysCompared compared;
  std::vector<double> breath_at_m;  ///< per line, towards the scanner, from its minimum
};

/// Separates latency and breath in a sweep forth and back, which sees each angle at two times: a
/// latency error shifts the ways across the line of sight, breath along it. Latency by robust least
/// squares, breath as one sine. `yaw_rad` uses the calibrated latency.
[[nodiscard]] TwoWay compare_ways(std::span<const TimedLine> lines, std::span<const double> yaw_rad,
                                  std::size_t turn, const ScannerCalibration& calibration);

}  // namespace tuina::scanner
