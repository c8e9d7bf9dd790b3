// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/no_go.hpp"

#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <cmath>
#include <optional>

#include "tuina/core/file.hpp"

namespace tuina::massage {
namespace {

using Words = std::vector<std::string>;

std::optional<Vector3> corner_of(const toml::node& node) {
  constexpr double largest_m = 3.0;  // a couch is smaller; millimetres are not
  const toml::array* numbers = node.as_array();
  if (numbers == nullptr || numbers->size() != 3) return std::nullopt;
  Vector3 corner;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = numbers->get(i)->value<double>();
    if (!value || !(std::abs(*value) <= largest_m)) return std::nullopt;
    corner[static_cast<Eigen::Index>(i)] = *value;
  }
  return corner;
}

NoGo entry_of(const toml::table& table, std::string_view file, Words& faults) {
  const auto reject = [&](const toml::node& node, std::string_view what) {
    faults.push_back(fmt::format("{}:{}: {}", file, node.source().begin.line, what));
  };
  NoGo entry;
  entry.name = table["name"].value_or("");
  if (entry.name.empty())
    reject(table, "a no_go needs a name in quotes, for the notes of the plan");
  for (const auto& [key, node] : table) {
    if (key.str() != "name" && key.str() != "corners_m") {
      reject(node, fmt::format("no_go has no `{}`; name and corners_m are known", key.str()));
    }
  }
  const toml::array* corners = table["corners_m"].as_array();
  if (corners == nullptr || corners->size() < 3) {
    const toml::node* given = table.get("corners_m");
    reject(given != nullptr ? *given : table,
           "corners_m is not a list of three or more [x, y, z] in couch, metres");
    return entry;
  }
  for (const toml::node& node : *corners) {
    if (const auto corner = corner_of(node)) {
      entry.corners_in_couch.push_back(*corner);
    } else {
      reject(node, "a corner is not three numbers in metres, within 3 m");
    }
  }
  return entry;
}

}  // namespace

Result<std::vector<NoGo>> parse_no_go(std::string_view text, std::string_view name) {
  try {
    const toml::table table = toml::parse(text, std::string(name));
    Words faults;
    std::vector<NoGo> entries;
    const toml::array* tables = table["no_go"].as_array();
    if (tables == nullptr || !tables->is_array_of_tables() || table.size() != 1) {
      return fail(Fault::config, "{}:1: [[no_go]] entries are needed, and nothing else", name);
    }
    for (const toml::node& node : *tables) {
      entries.push_back(entry_of(*node.as_table(), name, faults));
    }
    if (!faults.empty()) return fail(Fault::config, "{}", fmt::join(faults, "\n"));
    return entries;
  } catch (const toml::parse_error& error) {
    return fail(Fault::config, "{}:{}: {}", name, error.source().begin.line, error.description());
  }
}

Result<std::vector<NoGo>> read_no_go(const std::filesystem::path& file) {
  constexpr std::size_t largest_bytes = 1 << 20;
  const auto text = read_file(file, largest_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_no_go(*text, file.string());
}

}  // namespace tuina::massage
