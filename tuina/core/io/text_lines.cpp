// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/text_lines.hpp"

#include <fmt/format.h>

namespace tuina {

TextLines::TextLines(std::string_view text) : text_(text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text_.starts_with(byte_order_mark)) at_ = byte_order_mark.size();
}

std::optional<std::string_view> TextLines::next() {
  if (at_ >= text_.size()) return std::nullopt;
  const std::size_t end = text_.find('\n', at_);
  std::string_view line = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
  at_ = end == std::string_view::npos ? text_.size() : end + 1;
  ++number_;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

bool only_white_space(std::string_view text) {
  return text.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t enough = 40;
  std::string shown = "`";
  for (const char letter : text.substr(0, enough)) {
    const bool prints = letter >= ' ' && letter <= '~';
    shown += prints ? letter : '?';
  }
  if (text.size() > enough) shown += "...";
  return shown + '`';
}

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    constexpr char last_control = 0x1f, del = 0x7f;
    if (letter == '"' || letter == '\\')
      quoted += fmt::format("\\{}", letter);
    else if ((letter >= 0 && letter <= last_control) || letter == del)
      quoted += fmt::format("\\u{:04x}", static_cast<int>(letter));
    else
      quoted += letter;
  }
  return quoted + '"';
}

std::string listed(const std::vector<std::string>& words, std::string_view between,
                   std::size_t max_letters) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0 && list.size() + words[i].size() > max_letters)
      return fmt::format("{}{}and {} more", list, between, words.size() - i);
    list += i > 0 ? fmt::format("{}{}", between, words[i]) : words[i];
  }
  return list;
}

}  // namespace tuina
