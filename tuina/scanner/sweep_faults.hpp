// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/scanner/sweep.hpp"

namespace tuina::scanner {

/// Refuses, with the cause named, a sweep that lost too many frames on the way, whose frames are
/// not in the order in which they were taken, or whose motor stood still within a turn. `yaw_rad`
/// are the angles of the lines.
[[nodiscard]] Result<void> check_sequence(std::span<const TimedLine> lines,
                                          std::span<const YawReading> readings,
                                          std::span<const double> yaw_rad, double max_lost_share);

}  // namespace tuina::scanner
