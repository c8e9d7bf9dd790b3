// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace tuina::test {

/// Address of an empty database on a PostgreSQL server of this program alone, which listens on a
/// socket in its own folder only and ends with the program. Nothing where Debian's package is not
/// installed, or where no server may be started, which is then said.
[[nodiscard]] std::optional<std::string> empty_database();

}  // namespace tuina::test
