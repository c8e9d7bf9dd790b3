// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/evaluation/scanner/trials.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// Scanners as somebody built them, each calibrated as `tuina calibrate --rehearse` and `tuina
/// calibrate` do: 40 poses of a board photographed and found again, latency and couch from sweeps.
/// The laser line on the board is `line_share` times as bright as that of a red laser. Needs the
/// room `calibration`.
[[nodiscard]] Result<std::vector<BuiltScanner>> rehearsed_scanners(int count, std::uint64_t seed,
                                                                   bool upright,
                                                                   const Progress& progress,
                                                                   double line_share = 1.0);

}  // namespace tuina::app
