// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tuina::app {

/// A row is its cells; the same rows go to the terminal, the page and the JSON.
struct ResultTable {
  std::string title, note;
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows = {};
};

[[nodiscard]] std::string to_text(const ResultTable& table);
/// A `<section>` of a report page; `figures` is HTML and stands above the table.
[[nodiscard]] std::string to_html(const ResultTable& table, const std::string& figures);
/// An array with one object for every row, its keys the heads.
[[nodiscard]] nlohmann::json to_json(const ResultTable& table);

}  // namespace tuina::app
