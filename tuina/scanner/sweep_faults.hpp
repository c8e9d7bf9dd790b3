// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/scanner/sweep.hpp"

namespace tuina::scanner {

/// Fails, with the cause, when too many frames are lost, frames are out of order, or the motor
/// stalled. `yaw_rad`: angles of the lines.
[[nodiscard]] Result<void> check_sequence(std::span<const TimedLine> lines,
                                          std::span<const YawReading> readings,
                                          std::span<const double> yaw_rad, double max_lost_share);

}  // namespace tuina::scanner
