// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluation/tissue/trials.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// What a method did, by key; what is no number or never came is null.
[[nodiscard]] nlohmann::json to_json(const TrialResult& r, TrialMethod method);
/// The worst of the three tissues, key by key.
[[nodiscard]] TrialResult worst_of(const std::array<TrialResult, 3>& results);
/// The table of all methods, and the cells of one of them.
[[nodiscard]] telemetry::Table empty_table();
[[nodiscard]] std::vector<telemetry::Cell> cells_of(TrialMethod method,
                                                    const std::array<TrialResult, 3>& r);

}  // namespace tuina::app
