// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina {

/// A table of numbers read from a CSV file with a header row: the columns asked for, in the order
/// asked. LF and CRLF, a byte-order mark, a missing last newline and extra columns are accepted;
/// anything else that departs from the format is refused with file and line.
struct CsvTable {
  std::vector<std::vector<double>> columns;
  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

[[nodiscard]] Result<CsvTable> read_csv(const std::filesystem::path& path,
                                        const std::vector<std::string>& wanted_columns);

/// The same on text already in memory; `name` is what errors call it.
[[nodiscard]] Result<CsvTable> parse_csv(std::string_view text, std::string_view name,
                                         const std::vector<std::string>& wanted_columns);

}  // namespace tuina
