// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// One row as an object by the keys of the columns. An empty cell leaves its key out, a number that
/// is not finite is null.
[[nodiscard]] nlohmann::ordered_json to_json(const telemetry::Table& table,
                                             const telemetry::Row& row);

/// An array with one object for every row.
[[nodiscard]] nlohmann::ordered_json to_json(const telemetry::Table& table);

/// An object that has each row under its first cell.
[[nodiscard]] nlohmann::ordered_json to_json_by_name(const telemetry::Table& table);

}  // namespace tuina::app
