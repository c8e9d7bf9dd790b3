// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tuina::telemetry {

/// One place of a table. An empty cell says nothing anywhere; a number that is not finite is
/// unknown, which people see as a dash.
struct Cell {
  /// What a cell may hold.
  using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

  Cell() = default;
  /// @{
  /// A yes or no, a number, a text, something that may be unknown, or a value with a remark.
  Cell(bool claim) : value(claim) {}
  Cell(double number) : value(number) {}
  Cell(std::string text) : value(std::move(text)) {}
  Cell(const char* text) : value(std::string(text)) {}
  template <std::integral Whole>
  Cell(Whole number) : value(static_cast<std::int64_t>(number)) {}
  template <typename T>
  Cell(const std::optional<T>& known) {
    if (known) value = Cell(*known).value;
  }
  Cell(Value known, std::string behind) : value(std::move(known)), remark(std::move(behind)) {}
  /// @}

  Value value = {};
  std::string remark = {};  ///< small words behind the value: "± 0.3"
};

/// A column has a head for people and a key for JSON; without the one it is not shown, without the
/// other it is not in the JSON.
struct Column {
  std::string head = {};
  std::string key = {};            ///< "force.rmse_n" is the key `rmse_n` of an object `force`
  std::optional<int> digits = {};  ///< decimals that people see; none: four digits in all
  bool truth = false;              ///< shaded: known only in simulation
};

/// One line of a table.
struct Row {
  std::vector<Cell> cells;  ///< one per column
  std::string group = {};   ///< a heading above the rows that agree in it
  bool emphasised = false;
};

/// Rows that go to the terminal, to a page and to JSON alike.
struct Table {
  std::string title = {}, note = {};
  std::vector<Column> columns = {};
  std::vector<Row> rows = {};

  /// Adds a row; one cell per column.
  void add(std::vector<Cell> cells) { rows.push_back({.cells = std::move(cells)}); }
};

/// Columns whose heads are their keys.
[[nodiscard]] std::vector<Column> named_columns(const std::vector<std::string>& names);

/// A cell as people read it.
[[nodiscard]] std::string shown(const Cell& cell, const Column& column);

/// Title, columns as wide as they need to be, note.
[[nodiscard]] std::string to_text(const Table& table);

/// The `<table>` element, which scrolls where the page is narrow; without title and note.
[[nodiscard]] std::string to_html(const Table& table);

}  // namespace tuina::telemetry
