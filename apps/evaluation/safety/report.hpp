// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/evaluation/safety/campaign.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// Name of a cell's state, for tables and maps: "contact on bone", "travel".
[[nodiscard]] std::string state_of(const CampaignCell& cell);

[[nodiscard]] telemetry::Table failed_table(const Campaign& campaign);
[[nodiscard]] telemetry::Table class_table(const Campaign& campaign);
[[nodiscard]] telemetry::Table pair_table(const Campaign& campaign);
[[nodiscard]] telemetry::Table site_table(const Campaign& campaign);
[[nodiscard]] telemetry::Table session_table(const Campaign& campaign);
[[nodiscard]] telemetry::Table worst_table(const Campaign& campaign);
[[nodiscard]] telemetry::Table people_table(const Campaign& campaign);
/// Of random trials only those that violate a bound, or were stopped before their fault came.
[[nodiscard]] telemetry::Table random_table(const Campaign& campaign);
/// Faults of the list that nothing here has, and where each is held instead.
[[nodiscard]] telemetry::Table elsewhere_table();
/// In a sentence or two what was tried and what held.
[[nodiscard]] std::string summary_of(const Campaign& campaign);

[[nodiscard]] std::string to_json(const Campaign& campaign);
[[nodiscard]] std::string to_text(const Campaign& campaign);

/// One self-contained page; runs the worst cells again for their curves.
[[nodiscard]] Result<std::string> page_of(const Campaign& campaign);

}  // namespace tuina::app
