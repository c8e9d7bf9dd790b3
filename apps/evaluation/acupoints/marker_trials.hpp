// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/cli/mark_words.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// How far `surface` is off at the bumps on the skin of the scans (`*.ply`) of a folder, each of
/// which has `labels`: for each label how many people are marked, mean and largest error in
/// millimetres, the share within its radius; of each person the bumps and the errors; who was
/// refused and why, files that cannot be read among them. Fails when there is no scan.
[[nodiscard]] Result<nlohmann::json> judge_markers(const std::filesystem::path& folder,
                                                   const MarkGroup& labels,
                                                   const body::Atlas& atlas,
                                                   const Progress& progress);

/// The table that people read of it.
[[nodiscard]] std::string markers_text(const nlohmann::json& judged);

}  // namespace tuina::app
