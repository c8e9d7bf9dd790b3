// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/history/database.hpp"

namespace tuina::history {

/// Number of the schema that this version writes.
[[nodiscard]] std::int64_t newest_schema();

/// Brings the tables up to schema `to`, step by step, all of it or nothing. Refused: a database
/// that a newer version has written.
[[nodiscard]] Result<void> migrate(Database& database, std::int64_t to = newest_schema());

}  // namespace tuina::history
