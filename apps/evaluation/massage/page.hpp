// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/evaluation/massage/trials.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// A row of the table: which sessions, and what became of them.
struct SessionRow {
  std::string name;
  SessionSummary sum;
};

/// The keys of one row in `evaluate massage`, and what people see of them.
[[nodiscard]] telemetry::Table session_table(const std::vector<SessionRow>& rows);

/// Largest true force of presses and taps as a share of the plan, by their index at a place.
[[nodiscard]] telemetry::Table given_table(const std::vector<const SessionOutcome*>& outcomes);

/// alpha and beta as felt against those of the true first loading, and how often the intervals that
/// are said hold them.
[[nodiscard]] telemetry::Table felt_table(const std::vector<const SessionOutcome*>& outcomes);

/// What `evaluate massage` found, as one page that needs nothing else. `adaptive` are the same
/// sessions with steering and without, or empty.
[[nodiscard]] std::string session_page(const std::vector<SessionRow>& rows,
                                       const std::vector<SessionRow>& adaptive,
                                       const std::vector<SessionOutcome>& outcomes,
                                       const std::vector<std::string>& incidents);

}  // namespace tuina::app
