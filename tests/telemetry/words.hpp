// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace tuina::tests {

inline bool holds(const std::string& page, std::string_view words) {
  return page.find(words) != std::string::npos;
}

/// What a reader sees of a page: its words with one space between them, whatever the markup.
inline std::string words_of(const std::string& html) {
  std::string words;
  bool inside = false;
  const auto add = [&](char letter) {
    if (letter != ' ' || (!words.empty() && words.back() != ' ')) words += letter;
  };
  for (const char letter : html) {
    if (letter == '<') inside = true;
    if (!inside) add(letter == '\n' ? ' ' : letter);
    if (letter != '>') continue;
    inside = false;
    add(' ');
  }
  for (const auto& [escape, letter] :
       {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "&"}}) {
    for (auto at = words.find(escape); at != std::string::npos; at = words.find(escape, at + 1))
      words.replace(at, std::string_view(escape).size(), letter);
  }
  return words;
}

/// How often the words stand in a text.
inline std::size_t count(const std::string& text, std::string_view words) {
  std::size_t times = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    ++times;
  return times;
}

}  // namespace tuina::tests
