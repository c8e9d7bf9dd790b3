// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tuina {

/// Steps through a text line by line, LF or CRLF, and knows where it is for the sake of good
/// errors. It can be left at any line, because a header of text may be followed by binary data.
class TextLines {
 public:
  explicit TextLines(std::string_view text);

  /// The next line without its end; nothing when the text is used up.
  [[nodiscard]] std::optional<std::string_view> next();
  [[nodiscard]] std::size_t number() const { return number_; }  ///< of the last line, from 1
  [[nodiscard]] std::size_t byte() const { return at_; }        ///< of what follows it, from 0
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
};

/// Takes the next word, bounded by blanks, off the front of a line; empty when there is none.
[[nodiscard]] inline std::string_view take_word(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && (line[begin] == ' ' || line[begin] == '\t')) ++begin;
  std::size_t end = begin;
  while (end < line.size() && line[end] != ' ' && line[end] != '\t') ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// The whole word as a number of the type, in the C locale; "nan" and "inf" are numbers of a
/// floating type.
template <typename Number>
[[nodiscard]] std::optional<Number> to_number(std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Whether nothing but blanks and line ends is left.
[[nodiscard]] bool only_white_space(std::string_view text);

/// A piece of somebody's file as it may stand in an error: short, and only with letters that print.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace tuina
