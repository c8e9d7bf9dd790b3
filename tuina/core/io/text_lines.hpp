// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tuina {

/// Steps through text line by line (LF or CRLF) and keeps line and byte for errors. Reading may
/// stop at any line, since binary data may follow a text header.
class TextLines {
 public:
  /// The text must outlive it.
  explicit TextLines(std::string_view text);

  /// The next line without its line end; nothing at the end of the text.
  [[nodiscard]] std::optional<std::string_view> next();
  [[nodiscard]] std::size_t number() const {
    return number_;
  }  ///< line number of the last line, from 1
  [[nodiscard]] std::size_t byte() const {
    return at_;
  }  ///< byte offset of the text after it, from 0
  /// What follows the line read last.
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
};

/// Takes the next word off the front of a line; empty when there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && (line[begin] == ' ' || line[begin] == '\t')) ++begin;
  std::size_t end = begin;
  while (end < line.size() && line[end] != ' ' && line[end] != '\t') ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Parses the whole word as a number in the C locale, with or without a sign. Floating types accept
/// "nan" and "inf".
template <typename Number>
[[nodiscard]] std::optional<Number> to_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// True when only blanks and line ends are left.
[[nodiscard]] bool only_white_space(std::string_view text);

/// Quotes a piece of a user's file in an error: shortened, printable letters only.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// A string of TOML, with its quotes; whatever letters the text has, a reader gets it back.
[[nodiscard]] std::string toml_string(std::string_view text);

/// Joins words of an error. Words beyond `max_letters` are only counted: "GV4, BL47_L, and 9 more".
[[nodiscard]] std::string listed(const std::vector<std::string>& words,
                                 std::string_view between = ", ", std::size_t max_letters = 150);

}  // namespace tuina
