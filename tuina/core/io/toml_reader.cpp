// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/toml_reader.hpp"

#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tuina/core/io/near_miss.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina {
namespace {

std::string shortened(const std::string& value) {
  constexpr std::size_t max_letters = 40;
  return value.size() > max_letters ? value.substr(0, max_letters).append("...") : value;
}

/// " = value"; empty for lists and tables, which may be long.
std::string shown(const toml::node& node) {
  std::ostringstream text;
  if (node.is_value()) node.visit([&](const auto& value) { text << value; });
  const std::string value = text.str();
  return value.empty() ? value : " = " + shortened(value);
}

/// What is wrong with text that is no TOML, in words for people, and what a line may be.
std::string no_toml(const toml::parse_error& error, std::string_view text) {
  if (error.description().find("redefine") != std::string_view::npos)
    return "this key or section stands there twice";
  TextLines lines(text);
  std::string_view line;
  while (lines.number() < error.source().begin.line) {
    const auto next = lines.next();
    if (!next) break;
    line = *next;
  }
  return fmt::format("{} is not TOML; `key = value`, `[section]` or `# comment` is needed",
                     in_quotes(line));
}

std::optional<double> number_in(const toml::node& node) {
  const auto number = node.is_number() ? node.value<double>() : std::nullopt;
  return number && std::isfinite(*number) ? number : std::nullopt;
}

}  // namespace

std::string TomlFaults::at(const toml::node& node) const {
  return has_lines ? fmt::format("{}:{}: ", file, node.source().begin.line) : file + ": ";
}

std::optional<double> TomlValue::number() const {
  return number_in(*node_);
}

std::optional<std::string> TomlValue::text() const {
  return node_->is_string() ? node_->value<std::string>() : std::nullopt;
}

std::optional<std::vector<double>> TomlValue::numbers(std::size_t count) const {
  const toml::array* array = node_->as_array();
  if (array == nullptr || array->size() != count) return std::nullopt;
  std::vector<double> numbers;
  for (const toml::node& entry : *array) {
    const auto number = number_in(entry);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

bool TomlTable::has(std::string_view key) const {
  return table_->contains(key);
}

TomlTable::Words TomlTable::keys() const {
  Words keys;
  for (const auto& [key, node] : *table_) keys.emplace_back(key.str());
  return keys;
}

std::string TomlTable::at(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return faults_->at(node != nullptr ? *node : *table_);
}

void TomlTable::reject(std::string_view key, std::string_view sentence) const {
  faults_->all.push_back(at(key) + std::string(sentence));
}

void TomlTable::reject(const TomlValue& value, std::string_view sentence) const {
  faults_->all.push_back(faults_->at(value.node()) + std::string(sentence));
}

void TomlTable::wrong(std::string_view key, std::string_view predicate) const {
  const toml::node* node = table_->get(key);
  reject(key, fmt::format("{}{}{} {}", path_, key, node != nullptr ? shown(*node) : "", predicate));
}

void TomlTable::only(const Words& known, const Words& needed, std::string_view whose) const {
  Words missing;
  for (const std::string& key : needed) {
    if (!has(key)) missing.push_back(path_ + key);
  }
  if (!missing.empty()) {
    reject("", fmt::format("{} {} missing", listed(missing), missing.size() == 1 ? "is" : "are"));
  }
  Words all = known;
  all.insert(all.end(), needed.begin(), needed.end());
  for (const std::string& key : keys()) {
    if (std::find(all.begin(), all.end(), key) != all.end()) continue;
    const std::string unknown = whose.empty() ? fmt::format("`{}{}` is unknown", path_, key)
                                              : fmt::format("{} has no `{}`", whose, key);
    reject(key, fmt::format("{}; {}", unknown, suggestion(key, all)));
  }
}

std::optional<double> TomlTable::number(std::string_view key, double low, double high,
                                        std::string_view why) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const auto given = number_in(*node);
  if (given && *given >= low && *given <= high) return given;
  wrong(key,
        fmt::format("is not a number from {} to {}{}{}", low, high, why.empty() ? "" : ": ", why));
  return std::nullopt;
}

std::optional<int> TomlTable::whole(std::string_view key, int low, int high) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  const auto* given = node->as_integer();
  if (given != nullptr && given->get() >= low && given->get() <= high) {
    return static_cast<int>(given->get());
  }
  wrong(key, fmt::format("is not a whole number from {} to {}", low, high));
  return std::nullopt;
}

std::optional<bool> TomlTable::flag(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_boolean()) return node->as_boolean()->get();
  wrong(key, "is not true or false");
  return std::nullopt;
}

std::optional<std::string> TomlTable::text(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_string()) return node->as_string()->get();
  wrong(key, "is not a text in quotes");
  return std::nullopt;
}

std::optional<std::size_t> TomlTable::word(std::string_view key, const Words& words) const {
  const auto given = text(key);
  if (!given) return std::nullopt;
  const auto found = std::find(words.begin(), words.end(), *given);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  reject(key, fmt::format("{}{} = \"{}\" is unknown; {}", path_, key, shortened(*given),
                          suggestion(*given, words)));
  return std::nullopt;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key, std::size_t count,
                                                      double limit) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  auto given = TomlValue(*node).numbers(count);
  if (given && std::all_of(given->begin(), given->end(),
                           [&](double number) { return std::abs(number) <= limit; })) {
    return given;
  }
  wrong(key, fmt::format("is not {} numbers from {} to {}", count, -limit, limit));
  return std::nullopt;
}

std::optional<std::vector<TomlValue>> TomlTable::list(std::string_view key) const {
  const toml::node* node = table_->get(key);
  const toml::array* array = node != nullptr ? node->as_array() : nullptr;
  if (array == nullptr) return std::nullopt;
  std::vector<TomlValue> list;
  for (const toml::node& entry : *array) list.emplace_back(entry);
  return list;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_table()) {
    return TomlTable(*node->as_table(), fmt::format("{}{}.", path_, key), *faults_);
  }
  wrong(key, fmt::format("is not a table, [{}{}]", path_, key));
  return std::nullopt;
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr || !node->is_array_of_tables()) return {};
  std::vector<TomlTable> tables;
  for (const toml::node& entry : *node->as_array()) {
    tables.emplace_back(*entry.as_table(), path_, *faults_);
  }
  return tables;
}

Result<void> read_toml(std::string_view text, std::string_view name, Fault fault,
                       const std::function<void(const TomlTable&)>& read) {
  TomlFaults faults{.file = std::string(name), .has_lines = fault != Fault::usage};
  try {
    const toml::table root = toml::parse(text, name);
    read(TomlTable(root, "", faults));
  } catch (const toml::parse_error& error) {
    if (fault == Fault::usage) return fail(fault, "{}: {}", name, no_toml(error, text));
    return fail(fault, "{}:{}: {}", name, error.source().begin.line, no_toml(error, text));
  }
  if (!faults.all.empty()) return fail(fault, "{}", fmt::join(faults.all, "\n"));
  return {};
}

}  // namespace tuina
