// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::telemetry {

/// The section about the tissue: its map on the back, the law at each point, what changed, and what
/// that says of the person.
void add_tissue(Page& page, const ReportData& data);

}  // namespace tuina::telemetry
