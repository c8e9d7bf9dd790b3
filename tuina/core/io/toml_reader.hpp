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

/// What is wrong with one TOML file. All of it is collected, each with file and line, so that a
/// user mends the file once and not ten times.
struct TomlFaults {
  std::string file;
  bool has_lines = true;  ///< false for what was typed on the command line
  std::vector<std::string> all = {};

  [[nodiscard]] std::string at(const toml::node& node) const;  ///< "file:line: "
};

/// One entry of a list in a file.
class TomlValue {
 public:
  explicit TomlValue(const toml::node& node) : node_(&node) {}
  [[nodiscard]] std::optional<double> number() const;  ///< finite
  [[nodiscard]] std::optional<std::string> text() const;
  /// Nothing unless it is a list of so many finite numbers.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::size_t count) const;
  [[nodiscard]] const toml::node& node() const { return *node_; }

 private:
  const toml::node* node_;
};

/// One table of a file, read key by key. A read gives nothing where the key is absent, and where
/// the value is not what it must be; then the fault is collected.
class TomlTable {
 public:
  using Words = std::vector<std::string>;

  /// `path` stands before the keys in the faults, like "camera."; may be empty.
  TomlTable(const toml::table& table, std::string path, TomlFaults& faults)
      : table_(&table), path_(std::move(path)), faults_(&faults) {}

  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] Words keys() const;

  /// Where a key stands, or the table where it has no such key: "file:line: ".
  [[nodiscard]] std::string at(std::string_view key) const;
  /// A fault at the line of the key, or at that of the table where it has no such key.
  void reject(std::string_view key, std::string_view sentence) const;
  void reject(const TomlValue& value, std::string_view sentence) const;
  /// The same, and it begins with the key and its value.
  void wrong(std::string_view key, std::string_view predicate) const;
  /// Every other key is a fault, and so is each that `needed` names and that is not there. `whose`
  /// keys they are, like "a programme", is said where it helps.
  void only(const Words& known, const Words& needed = {}, std::string_view whose = "") const;

  [[nodiscard]] std::optional<double> number(std::string_view key, double low, double high,
                                             std::string_view why = "") const;
  [[nodiscard]] std::optional<int> whole(std::string_view key, int low, int high) const;
  [[nodiscard]] std::optional<bool> flag(std::string_view key) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
  /// The index of the word given, among the words allowed.
  [[nodiscard]] std::optional<std::size_t> word(std::string_view key, const Words& words) const;
  /// So many numbers, each between -limit and limit.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count,
                                                           double limit) const;

  /// Absent, or no list: nothing, without a fault.
  [[nodiscard]] std::optional<std::vector<TomlValue>> list(std::string_view key) const;
  /// Its keys are shown with its name before.
  [[nodiscard]] std::optional<TomlTable> table(std::string_view key) const;
  /// [[key]]; empty without a fault where there are none, or where not all are tables.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;

 private:
  const toml::table* table_;
  std::string path_;
  TomlFaults* faults_;
};

/// Parses a file and lets `read` read its root. Fails with `fault`, a line for each thing that is
/// wrong; `name` stands before them, without a line where the fault is one of usage.
[[nodiscard]] Result<void> read_toml(std::string_view text, std::string_view name, Fault fault,
                                     const std::function<void(const TomlTable&)>& read);

}  // namespace tuina
