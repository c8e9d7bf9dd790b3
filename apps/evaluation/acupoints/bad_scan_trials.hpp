// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tuina/body/atlas.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// What `surface` answers on every kind of bad scan of so many fresh phantoms in each position: how
/// many are answered; place errors and radii of their seven points, in millimetres; points that are
/// wrong and sure; why the others are refused.
[[nodiscard]] nlohmann::json judge_bad_scans(int phantoms, std::uint64_t seed,
                                             const body::Atlas& atlas, const Progress& progress);

/// The table that people read of it.
[[nodiscard]] std::string bad_scans_text(const nlohmann::json& judged);

}  // namespace tuina::app
