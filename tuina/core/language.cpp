// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/language.hpp"

namespace tuina {

const std::string* Language::message(std::string_view key) const {
  const auto found = messages_.find(key);
  return found == messages_.end() ? nullptr : &found->second;
}

std::string Language::operator()(std::string_view words) const {
  if (const std::string* known = message(words)) return *known;
  const std::size_t end = words.find(' ');
  if (end == std::string_view::npos) return std::string(words);
  const std::string* technique = message(words.substr(0, end));
  if (technique == nullptr) return std::string(words);
  std::string said = *technique;
  for (std::size_t at = end; at != std::string_view::npos;) {
    const std::size_t next = words.find(' ', at + 1);
    const std::string_view place = words.substr(at + 1, next - at - 1);
    said += " " + (place == "to" ? (*this)(place) : std::string(place));
    at = next;
  }
  return said;
}

std::string Language::operator()(const Sentence& one) const {
  const std::string* pattern = one.key.empty() ? message(one.words) : message(one.key);
  if (pattern == nullptr) return one.words;
  std::string said;
  for (std::size_t at = 0; at < pattern->size(); ++at) {
    const bool value =
        (*pattern)[at] == '{' && at + 2 < pattern->size() && (*pattern)[at + 2] == '}';
    if (!value) {
      said += (*pattern)[at];
      continue;
    }
    const auto number = static_cast<std::size_t>((*pattern)[at + 1] - '0');
    if (number < one.values.size()) said += (*this)(one.values[number]);
    at += 2;
  }
  return said;
}

std::vector<std::string> Language::operator()(const std::vector<Sentence>& all) const {
  std::vector<std::string> said;
  said.reserve(all.size());
  for (const Sentence& one : all) said.push_back((*this)(one));
  return said;
}

}  // namespace tuina
