// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <optional>

#include "tuina/core/io/text_lines.hpp"

namespace tuina::app {

Check number_between(double low, double high) {
  return [low, high](const std::string& word) -> std::string {
    const auto value = to_number<double>(word);
    if (value && *value >= low && *value <= high) return {};
    return fmt::format("{} is not a number from {} to {}", in_quotes(word), low, high);
  };
}

Option Option::check(Check check, const std::string& shown) const {
  option_->check(
      CLI::Validator([check = std::move(check)](std::string& word) { return check(word); }, shown));
  return *this;
}

Option Option::between(double low, double high) const {
  return check(number_between(low, high), fmt::format("{} to {}", low, high));
}

Option Option::one_of(const std::vector<std::string>& words) const {
  return check(
      [words](const std::string& word) -> std::string {
        if (std::find(words.begin(), words.end(), word) != words.end()) return {};
        return fmt::format("{} is unknown; known: {}", in_quotes(word), listed(words));
      },
      fmt::format("{{{}}}", fmt::join(words, ",")));
}

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::show_default() const {
  option_->capture_default_str();
  return *this;
}

Option Option::needs(Option other) const {
  option_->needs(other.option_);
  return *this;
}

Option Option::excludes(Option other) const {
  option_->excludes(other.option_);
  return *this;
}

Option Option::delimiter(char between) const {
  option_->delimiter(between);
  return *this;
}

Option Option::one_word_each() const {
  option_->allow_extra_args(false);
  return *this;
}

template <typename Value>
Option Options::add(const std::string& name, Value& value, const std::string& help) {
  return Option(command_.add_option(name, value, help));
}

Option Options::flag(const std::string& name, bool& value, const std::string& help) {
  return Option(command_.add_flag(name, value, help));
}

Option Options::named(const std::string& name) const {
  return Option(command_.get_option(name));
}

// Every kind of value that a verb has; another one is added here.
template Option Options::add(const std::string&, std::string&, const std::string&);
template Option Options::add(const std::string&, double&, const std::string&);
template Option Options::add(const std::string&, int&, const std::string&);
template Option Options::add(const std::string&, std::uint64_t&, const std::string&);
template Option Options::add(const std::string&, std::optional<double>&, const std::string&);
template Option Options::add(const std::string&, std::vector<int>&, const std::string&);
template Option Options::add(const std::string&, std::vector<std::string>&, const std::string&);

}  // namespace tuina::app
