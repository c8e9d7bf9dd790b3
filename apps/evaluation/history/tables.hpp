// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/cli/table.hpp"
#include "apps/evaluation/history/outcome_fields.hpp"
#include "tuina/core/result.hpp"

namespace tuina::app {

/// @{
/// What people who come back give, a row for each way; every outcome is there.
[[nodiscard]] telemetry::Table days_table(const std::vector<Result<DaysOfOne>>& people);
[[nodiscard]] telemetry::Table power_table(const std::vector<Result<PowerOutcome>>& tested);
[[nodiscard]] telemetry::Table points_table(const std::vector<Result<PointsOutcome>>& people);
[[nodiscard]] telemetry::Table others_table(const std::vector<Result<PointsOutcome>>& people);
/// @}

}  // namespace tuina::app
