// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina {

/// The wanted columns of a CSV file with a header row, in the order wanted. Accepts LF and CRLF, a
/// byte-order mark, a missing last newline and extra columns; refuses every other departure from
/// the format with file and line.
struct CsvTable {
  std::vector<std::vector<double>> columns;
  /// Rows below the head.
  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Reads the wanted columns of a file. An empty cell of the column `may_be_empty` is NaN; every
/// other cell is a finite number.
[[nodiscard]] Result<CsvTable> read_csv(const std::filesystem::path& path,
                                        const std::vector<std::string>& wanted_columns,
                                        std::string_view may_be_empty = {});

/// Parses text in memory; `name` stands for the file in errors. A cell of the column `may_be_empty`
/// is NaN where it is empty.
[[nodiscard]] Result<CsvTable> parse_csv(std::string_view text, std::string_view name,
                                         const std::vector<std::string>& wanted_columns,
                                         std::string_view may_be_empty = {});

}  // namespace tuina
