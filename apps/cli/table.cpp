// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/table.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

struct AsJson {
  ordered_json operator()(std::monostate) const { return {}; }
  ordered_json operator()(double number) const {
    return std::isfinite(number) ? ordered_json(number) : ordered_json();
  }
  ordered_json operator()(const auto& value) const { return value; }
};

}  // namespace

ordered_json to_json(const telemetry::Table& table, const telemetry::Row& row) {
  ordered_json object = ordered_json::object();
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    const std::string& key = table.columns[i].key;
    const telemetry::Cell::Value& value = row.cells[i].value;
    if (key.empty() || std::holds_alternative<std::monostate>(value)) continue;
    const std::size_t inner = key.find('.');
    ordered_json& place = inner == std::string::npos
                              ? object[key]
                              : object[key.substr(0, inner)][key.substr(inner + 1)];
    place = std::visit(AsJson{}, value);
  }
  return object;
}

ordered_json to_json(const telemetry::Table& table) {
  ordered_json rows = ordered_json::array();
  for (const telemetry::Row& row : table.rows) rows.push_back(to_json(table, row));
  return rows;
}

ordered_json to_json_by_name(const telemetry::Table& table) {
  ordered_json rows = ordered_json::object();
  for (const telemetry::Row& row : table.rows)
    rows[telemetry::shown(row.cells.front(), {})] = to_json(table, row);
  return rows;
}

}  // namespace tuina::app
