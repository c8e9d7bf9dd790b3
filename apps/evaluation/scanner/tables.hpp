// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/evaluation/scanner/proof.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// Depth errors of one wall after the other.
[[nodiscard]] telemetry::Table wall_table(const std::vector<WallTrial>& walls);

/// Scans of backs, one row for each condition by its name.
[[nodiscard]] telemetry::Table back_table(const std::map<std::string, BackTrial>& backs);

/// Scans of backs while one condition is made worse.
[[nodiscard]] telemetry::Table curve_table(const Curve& curve);

/// Everything that was wanted, and whether it is reached.
[[nodiscard]] telemetry::Table target_table(const std::vector<Target>& targets);

/// A sentence each about the box and the sphere.
[[nodiscard]] std::string sentence_of(const scanner::FoundBox& box);
[[nodiscard]] std::string sentence_of(const scanner::FoundSphere& sphere);

}  // namespace tuina::app
