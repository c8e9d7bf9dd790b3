// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// The section of the report about what was felt: the map of stiffness, the laws of the points,
/// before and after, and what they say of the person's build.
[[nodiscard]] std::string tissue_section(const ReportData& data);

}  // namespace tuina::telemetry
