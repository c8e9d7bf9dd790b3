// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/telemetry/report_data.hpp"

namespace tuina::telemetry {

/// How far the arms stayed from each other, as a plot; empty when nobody measured it.
[[nodiscard]] std::string distance_figure(const ReportData& data);

/// The section about what the tissue decided, line by line with its reason; empty when it decided
/// nothing.
[[nodiscard]] std::string decisions_section(const ReportData& data);

}  // namespace tuina::telemetry
