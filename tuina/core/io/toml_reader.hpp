// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"

namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace tuina {

/// All faults of one TOML file, each with file and line, so that a user mends the file once.
struct TomlFaults {
  std::string file;
  bool has_lines = true;  ///< false for `--set` values from the command line
  std::vector<std::string> all = {};

  [[nodiscard]] std::string at(const toml::node& node) const;  ///< "file:line: "
};

/// One entry of a list.
class TomlValue {
 public:
  /// The node must outlive it.
  explicit TomlValue(const toml::node& node) : node_(&node) {}
  [[nodiscard]] std::optional<double> number() const;  ///< finite
  /// Nothing unless it is a text.
  [[nodiscard]] std::optional<std::string> text() const;
  /// Nothing unless it is a list of `count` finite numbers.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::size_t count) const;
  /// For what toml++ itself is asked.
  [[nodiscard]] const toml::node& node() const { return *node_; }

 private:
  const toml::node* node_;
};

/// One table of a file, read key by key. A read returns nothing when the key is absent, and also
/// when the value is wrong; the fault is then collected.
class TomlTable {
 public:
  /// Keys, or the words that a value may be.
  using Words = std::vector<std::string>;

  /// `path`: prefix of the keys in faults, such as "camera."; may be empty.
  TomlTable(const toml::table& table, std::string path, TomlFaults& faults)
      : table_(&table), path_(std::move(path)), faults_(&faults) {}

  /// Whether the key is there, whatever its value.
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] Words keys() const;  ///< keys of the table

  /// Location of the key, or of the table if the key is absent: "file:line: ".
  [[nodiscard]] std::string at(std::string_view key) const;
  /// Collects a fault at `at(key)`.
  void reject(std::string_view key, std::string_view sentence) const;
  /// Collects a fault at an entry of a list.
  void reject(const TomlValue& value, std::string_view sentence) const;
  /// Collects a fault whose sentence begins with the key and its value.
  void wrong(std::string_view key, std::string_view predicate) const;
  /// Collects a fault for every unknown key and for every missing key of `needed`. `whose` names
  /// the owner of the keys, such as "a programme", in the message.
  void only(const Words& known, const Words& needed = {}, std::string_view whose = "") const;

  /// @{
  /// A value of the type, numbers from `low` to `high`. Nothing where the key is not there or its
  /// value is another, which is collected with `why`.
  [[nodiscard]] std::optional<double> number(std::string_view key, double low, double high,
                                             std::string_view why = "") const;
  [[nodiscard]] std::optional<int> whole(std::string_view key, int low, int high) const;
  [[nodiscard]] std::optional<bool> flag(std::string_view key) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
  /// @}
  /// Index of the value in `words`.
  [[nodiscard]] std::optional<std::size_t> word(std::string_view key, const Words& words) const;
  /// A list of `count` numbers, each between -limit and limit.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count,
                                                           double limit) const;

  /// The entries of a list; nothing, without a fault, when the key is absent or no list.
  [[nodiscard]] std::optional<std::vector<TomlValue>> list(std::string_view key) const;
  /// A sub-table; its name is prefixed to its keys in faults.
  [[nodiscard]] std::optional<TomlTable> table(std::string_view key) const;
  /// The tables of [[key]]; empty, without a fault, when there are none or not all are tables.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;

 private:
  const toml::table* table_;
  std::string path_;
  TomlFaults* faults_;
};

/// Parses text and lets `read` read its root table. Fails with `fault` and one line per fault;
/// `name` begins each line.
[[nodiscard]] Result<void> read_toml(std::string_view text, std::string_view name, Fault fault,
                                     const std::function<void(const TomlTable&)>& read);

}  // namespace tuina
