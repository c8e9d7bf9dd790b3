// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/csv.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina {
namespace {

constexpr std::size_t max_csv_bytes = std::size_t{256} << 20;

/// `cells` keeps its memory from line to line: a file may have millions.
void split(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

/// Index of each wanted column in the header; fails when one is missing or a name occurs twice.
Result<std::vector<std::size_t>> find_columns(std::string_view header, std::string_view name,
                                              const std::vector<std::string>& wanted) {
  std::vector<std::string_view> names;
  split(header, names);
  auto sorted = names;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twin = std::adjacent_find(sorted.begin(), sorted.end()); twin != sorted.end()) {
    return fail(Fault::bad_input, "{}:1: the column {} stands twice in the header", name,
                in_quotes(*twin));
  }
  std::vector<std::size_t> places;
  for (const std::string& column : wanted) {
    const auto found = std::find(names.begin(), names.end(), column);
    if (found == names.end()) {
      return fail(Fault::bad_input, "{}:1: no column `{}` in the header {}; needed: {}", name,
                  column, in_quotes(header), listed(wanted, ","));
    }
    places.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  return places;
}

}  // namespace

Result<CsvTable> parse_csv(std::string_view text, std::string_view name,
                           const std::vector<std::string>& wanted_columns,
                           std::string_view may_be_empty) {
  // Blank lines after the last row are allowed; anywhere else a blank line is a fault.
  while (!text.empty() && only_white_space(text.substr(text.size() - 1))) text.remove_suffix(1);
  TextLines lines(text);
  const auto header = lines.next();
  if (!header)
    return fail(Fault::bad_input, "{}: is empty; a header row with {} is needed", name,
                listed(wanted_columns, ","));
  const auto places = find_columns(*header, name, wanted_columns);
  if (!places) return tl::unexpected(places.error());
  const auto width = static_cast<std::size_t>(std::count(header->begin(), header->end(), ',')) + 1;

  CsvTable table;
  table.columns.resize(wanted_columns.size());
  std::vector<std::string_view> cells;
  while (const auto line = lines.next()) {
    split(*line, cells);
    if (cells.size() != width) {
      return fail(Fault::bad_input, "{}:{}: {} cells, the header has {}: {}", name, lines.number(),
                  cells.size(), width, in_quotes(*line));
    }
    for (std::size_t k = 0; k < wanted_columns.size(); ++k) {
      if (cells[(*places)[k]].empty() && wanted_columns[k] == may_be_empty) {
        table.columns[k].push_back(std::numeric_limits<double>::quiet_NaN());
        continue;
      }
      const auto value = to_number<double>(cells[(*places)[k]]);
      if (!value || !std::isfinite(*value)) {
        return fail(Fault::bad_input, "{}:{}: {} is {}, a finite number is needed", name,
                    lines.number(), wanted_columns[k], in_quotes(cells[(*places)[k]]));
      }
      table.columns[k].push_back(*value);
    }
  }
  if (lines.number() == 1) return fail(Fault::bad_input, "{}:2: no row follows the header", name);
  return table;
}

Result<CsvTable> read_csv(const std::filesystem::path& path,
                          const std::vector<std::string>& wanted_columns,
                          std::string_view may_be_empty) {
  const auto text = read_file(path, max_csv_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_csv(*text, path.string(), wanted_columns, may_be_empty);
}

}  // namespace tuina
