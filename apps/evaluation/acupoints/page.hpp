// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/evaluation/acupoints/trials.hpp"

namespace tuina::app {

/// What `evaluate acupoints` found as one self-contained page: the tables, a plot of every error
/// against its share, and a contact sheet with the true and the found points on each back.
[[nodiscard]] std::string acupoint_page(const nlohmann::json& answer,
                                        const std::map<std::string, Score>& scores,
                                        const std::vector<body::LabelledBody>& people);

}  // namespace tuina::app
