// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluation/acupoints/trials.hpp"

namespace tuina::app {

/// The keys of one method in `evaluate acupoints`: mean, SD, p95, max and the RMSE on each axis,
/// over the seven points, by position, body type, arms and point; coverage of the uncertainty;
/// failures; time.
[[nodiscard]] nlohmann::json to_json(const Score& score);

/// Seconds from the person on the couch to the plan beside the thesis and teach-and-play.
[[nodiscard]] nlohmann::json to_json(const Times& times);

/// The tables for people.
[[nodiscard]] std::string text_of(const nlohmann::json& methods);

}  // namespace tuina::app
