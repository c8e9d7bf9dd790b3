// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {

std::string to_text(const ResultTable& table) {
  std::string text = table.title + "\n";
  std::vector<std::size_t> widths(table.heads.size());
  const auto measure = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
  };
  measure(table.heads);
  for (const auto& row : table.rows) measure(row);
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      text += fmt::format("  {:<{}}", cells[i], widths[i]);
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  };
  add(table.heads);
  for (const auto& row : table.rows) add(row);
  return text + "  " + table.note + "\n\n";
}

std::string to_html(const ResultTable& table, const std::string& figures) {
  std::string html =
      fmt::format("<section><h2>{}</h2><p>{}</p>{}<div class=\"wide\"><table><thead><tr>",
                  table.title, table.note, figures);
  for (const auto& head : table.heads) html += fmt::format("<th>{}</th>", head);
  html += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const auto& cell : row) html += fmt::format("<td>{}</td>", telemetry::escaped(cell));
    html += "</tr>";
  }
  return html + "</tbody></table></div></section>";
}

nlohmann::json to_json(const ResultTable& table) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : table.rows) {
    nlohmann::json object;
    for (std::size_t i = 0; i < row.size(); ++i) object[table.heads[i]] = row[i];
    rows.push_back(object);
  }
  return rows;
}

}  // namespace tuina::app
