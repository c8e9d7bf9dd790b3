// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluation/acupoints/trials.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// The keys of one method in `evaluate acupoints`: mean, SD, p95, max and the RMSE on each axis,
/// over the seven points, by position, body type, arms and point; coverage of the uncertainty;
/// failures; time.
[[nodiscard]] nlohmann::json to_json(const Score& score);

/// Seconds from the person on the couch to the plan beside the thesis and teach-and-play.
[[nodiscard]] nlohmann::json to_json(const Times& times);

/// The methods beside each other: by position and body type, and how errors are spread.
[[nodiscard]] telemetry::Table place_table(const nlohmann::json& methods);
[[nodiscard]] telemetry::Table spread_table(const nlohmann::json& methods);
/// How the errors of one method are spread, point by point.
[[nodiscard]] telemetry::Table point_table(const nlohmann::json& method);
/// The points of the seven that follow when others were palpated: their mean errors, the share of
/// their errors without the finger, how many lie within their radius.
[[nodiscard]] nlohmann::json palpated_json(const std::map<std::string, Score>& scores);
[[nodiscard]] telemetry::Table palpated_table(const std::map<std::string, Score>& scores);
/// Seconds to the plan.
[[nodiscard]] telemetry::Table time_table(const nlohmann::json& times);

/// A number of a group that may be missing: a cell that says "-" then.
[[nodiscard]] telemetry::Cell number_in(const nlohmann::json& group, const char* key,
                                        double scale = 1.0);

}  // namespace tuina::app
