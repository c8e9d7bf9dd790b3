// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tuina/core/result.hpp"
#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::record {

/// What the report shows of a session, from the files in its folder and nothing else. Refused, with
/// file and key or line: a folder that is not that of a session.
[[nodiscard]] Result<telemetry::ReportData> read_record(const std::filesystem::path& folder);

}  // namespace tuina::record
