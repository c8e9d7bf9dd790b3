// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tuina::app {

/// Text that says what is wrong with a word of the command line, empty when nothing is.
using Check = std::function<std::string(const std::string& word)>;

/// Refuses NaN and numbers outside [low, high].
[[nodiscard]] Check number_between(double low, double high);

/// One option or flag of a verb; a handle that may be copied.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  /// Refuses what does not pass; `shown`, if any, stands beside the option in --help.
  Option check(Check check, const std::string& shown = {}) const;
  Option between(double low, double high) const;
  Option one_of(const std::vector<std::string>& words) const;
  Option required() const;
  Option show_default() const;
  Option needs(Option other) const;
  Option excludes(Option other) const;
  /// Of a list: its items stand in one word, with this between them.
  Option delimiter(char between) const;
  /// Of a list: each item comes with the option's name before it.
  Option one_word_each() const;

 private:
  CLI::Option* option_;
};

/// Options of one verb, which write into its members: texts, numbers, lists and optional ones of
/// these. CLI11 stands behind it, read by two sources alone, since it is all header and takes
/// longer to compile than a verb does.
class Options {
 public:
  explicit Options(CLI::App& command) : command_(command) {}

  template <typename Value>
  Option add(const std::string& name, Value& value, const std::string& help = {});
  Option flag(const std::string& name, bool& value, const std::string& help);
  /// The option of that name, which was added before.
  [[nodiscard]] Option named(const std::string& name) const;

 private:
  CLI::App& command_;
};

}  // namespace tuina::app
