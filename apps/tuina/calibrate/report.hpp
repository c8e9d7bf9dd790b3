// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/calibration/calibrate.hpp"

namespace tuina::app {

/// What would make the calibration better, in sentences, the most useful first.
[[nodiscard]] std::vector<std::string> advice(const calibration::Calibrated& result,
                                              const calibration::Views& views);

/// One self-contained HTML page: how good the calibration is, which boards were seen where, how
/// well each agrees, and what to do next.
[[nodiscard]] std::string calibration_report(const calibration::Calibrated& result,
                                             const calibration::Views& views,
                                             const std::string& folder);

}  // namespace tuina::app
