// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tuina {

/// A sentence for people: whole in English, and its key with what stands in it, for who says it in
/// another language.
struct Sentence {
  std::string words;
  std::string key = {};  ///< empty: there is English alone
  std::vector<std::string> values = {};
  [[nodiscard]] bool empty() const { return words.empty(); }  ///< nothing is said
  bool operator==(const Sentence&) const = default;           ///< all of it is the same
};

/// The English of all.
[[nodiscard]] inline std::vector<std::string> words_of(std::span<const Sentence> all) {
  std::vector<std::string> words;
  words.reserve(all.size());
  for (const Sentence& one : all) words.push_back(one.words);
  return words;
}

/// The sentence of a key. Its values are the arguments in their order, each as the English has it;
/// `words` names them in that order, too.
template <typename... Args>
[[nodiscard]] Sentence sentence(std::string key,  // NOLINT: it is moved from
                                fmt::format_string<Args...> words, const Args&... args) {
  const fmt::string_view pattern = words;
  [[maybe_unused]] std::string_view rest(pattern.data(), pattern.size());
  [[maybe_unused]] const auto next = [&rest](const auto& arg) {
    rest.remove_prefix(rest.find('{'));
    const std::string_view place = rest.substr(0, rest.find('}') + 1);
    rest.remove_prefix(place.size());
    return fmt::vformat(place, fmt::make_format_args(arg));
  };
  return {.words = fmt::vformat(pattern, fmt::make_format_args(args...)),
          .key = std::move(key),
          .values = {next(args)...}};
}

}  // namespace tuina
