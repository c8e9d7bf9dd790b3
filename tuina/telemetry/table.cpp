// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "tuina/telemetry/plot/svg_parts.hpp"

namespace tuina::telemetry {
namespace {

/// Code points, which a terminal shows as one letter each.
std::size_t letters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

std::string number_text(double number, std::optional<int> digits) {
  if (!std::isfinite(number)) return "-";
  const std::string text =
      digits ? fmt::format("{:.{}f}", number, *digits) : fmt::format("{:.4g}", number);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return zero && text.starts_with('-') ? text.substr(1) : text;
}

bool reads_as_number(const std::string& text) {
  return text.find_first_of("0123456789") != std::string::npos &&
         text.find_first_not_of("0123456789.,+-/%<> ") == std::string::npos;
}

/// Numbers stand to the right, words and the name of a row to the left.
bool stands_right(const Table& table, std::size_t column) {
  return column > 0 && std::any_of(table.rows.begin(), table.rows.end(), [&](const Row& row) {
           const Cell::Value& value = row.cells[column].value;
           const auto* text = std::get_if<std::string>(&value);
           return text != nullptr ? reads_as_number(*text) : value.index() > 1;
         });
}

/// The words of a head in lines that are no longer than `width` unless a word is.
std::vector<std::string> wrapped(const std::string& head, std::size_t width) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < head.size();) {
    const std::size_t end = std::min(head.find(' ', at), head.size());
    const std::string word = head.substr(at, end - at);
    if (lines.empty() || letters(lines.back()) + 1 + letters(word) > width) {
      lines.push_back(word);
    } else {
      lines.back() += " " + word;
    }
    at = end + 1;
  }
  return lines;
}

/// A column as the terminal shows it.
struct TextColumn {
  std::vector<std::string> head, cells;
  std::size_t width = 0;
  bool right = false;

  [[nodiscard]] std::string padded(const std::string& text) const {
    const std::string space(width - std::min(width, letters(text)), ' ');
    return "  " + (right ? space + text : text + space);
  }
};

std::string with_remark(const Cell& cell, const Column& column) {
  return shown(cell, column) + (cell.remark.empty() ? "" : " " + cell.remark);
}

TextColumn text_column(const Table& table, std::size_t index) {
  constexpr std::size_t head_width = 12;
  TextColumn column{.right = stands_right(table, index)};
  for (const Row& row : table.rows) {
    column.cells.push_back(with_remark(row.cells[index], table.columns[index]));
    column.width = std::max(column.width, letters(column.cells.back()));
  }
  column.head = wrapped(table.columns[index].head, std::max(head_width, column.width));
  for (const std::string& line : column.head) column.width = std::max(column.width, letters(line));
  return column;
}

std::string line_of(const std::vector<TextColumn>& columns, const auto& text_in) {
  std::string line;
  for (const TextColumn& column : columns) line += column.padded(text_in(column));
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

std::string html_cell(const Cell& cell, const Column& column, bool right) {
  constexpr std::size_t one_line = 44;
  const std::string text = shown(cell, column);
  std::string classes = right ? "" : letters(text) > one_line ? "l long" : "l";
  if (column.truth) classes += classes.empty() ? "sim" : " sim";
  return fmt::format("<td{}>{}{}</td>", classes.empty() ? "" : " class=\"" + classes + "\"",
                     escaped(text),
                     cell.remark.empty() ? "" : "<em>" + escaped(cell.remark) + "</em>");
}

}  // namespace

std::vector<Column> named_columns(const std::vector<std::string>& names) {
  std::vector<Column> columns;
  columns.reserve(names.size());
  for (const std::string& name : names) columns.push_back({.head = name, .key = name});
  return columns;
}

std::string shown(const Cell& cell, const Column& column) {
  if (const auto* claim = std::get_if<bool>(&cell.value)) return *claim ? "yes" : "no";
  if (const auto* whole = std::get_if<std::int64_t>(&cell.value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&cell.value))
    return number_text(*number, column.digits);
  const auto* text = std::get_if<std::string>(&cell.value);
  return text != nullptr ? *text : "";
}

std::string to_text(const Table& table) {
  std::vector<TextColumn> columns;
  std::size_t head_lines = 0;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].head.empty()) continue;
    columns.push_back(text_column(table, i));
    head_lines = std::max(head_lines, columns.back().head.size());
  }
  std::string text = table.title.empty() ? "" : table.title + "\n";
  for (std::size_t k = 0; k < head_lines; ++k) {
    // Heads of fewer lines stand on the last ones.
    text += line_of(columns, [&](const TextColumn& column) {
      const std::size_t above = head_lines - column.head.size();
      return k < above ? std::string() : column.head[k - above];
    });
  }
  std::string group;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (table.rows[row].group != group) text += "  " + table.rows[row].group + "\n";
    group = table.rows[row].group;
    text += line_of(columns, [row](const TextColumn& column) { return column.cells[row]; });
  }
  return text + (table.note.empty() ? "" : "  " + table.note + "\n");
}

std::string to_html(const Table& table) {
  constexpr std::size_t many_columns = 10;
  std::vector<std::size_t> visible;
  std::vector<bool> right;
  std::string html;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    right.push_back(stands_right(table, i));
    if (table.columns[i].head.empty()) continue;
    visible.push_back(i);
    html += fmt::format("<th class=\"{}{}\">{}</th>", right[i] ? "" : "l",
                        table.columns[i].truth ? " sim" : "", escaped(table.columns[i].head));
  }
  html = fmt::format("<div class=\"wide\"><table{}><thead><tr>{}",
                     visible.size() < many_columns ? "" : " class=\"dense\"", html);
  html += "</tr></thead><tbody>";
  std::string group;
  for (const Row& row : table.rows) {
    assert(row.cells.size() == table.columns.size());
    if (row.group != group) {
      html += fmt::format("<tr><td class=\"group\" colspan=\"{}\">{}</td></tr>", visible.size(),
                          escaped(row.group));
      group = row.group;
    }
    html += row.emphasised ? "<tr class=\"ours\">" : "<tr>";
    for (const std::size_t i : visible) html += html_cell(row.cells[i], table.columns[i], right[i]);
    html += "</tr>";
  }
  return html + "</tbody></table></div>";
}

}  // namespace tuina::telemetry
