// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "tuina/history/fleet.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::history {

/// A robot that says nothing for so long is not heard: it is off, or without a network.
inline constexpr double max_silence_s = 60.0;

/// Seconds between two stamps like "2026-11-22T14:03:05Z"; NaN where one of them is none.
[[nodiscard]] double seconds_between(const std::string& from, const std::string& to);

/// A row for each robot: what it does at the time `now`, or when it was heard last; what its
/// sessions came to.
[[nodiscard]] telemetry::Table fleet_table(std::span<const MachineHistory> fleet,
                                           const std::string& now);

/// The page of all robots: the table, stops with their causes, and of each robot the zeros of its
/// sensors and its accuracy over time. One self-contained HTML file.
[[nodiscard]] std::string fleet_page(std::span<const MachineHistory> fleet, const std::string& now);

}  // namespace tuina::history
