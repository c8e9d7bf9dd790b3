// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/sentence.hpp"

namespace tuina {

/// One language of people. What has a message is said by that; all else, and with no messages
/// everything, stays English. A message has {0} where the first value of its sentence stands.
class Language {
 public:
  /// What says each key, or each English sentence or name that has no key.
  using Messages = std::map<std::string, std::string, std::less<>>;

  /// English.
  Language() = default;
  /// The language of a BCP 47 tag, such as "zh-Hant".
  Language(std::string tag, Messages messages)
      : tag_(std::move(tag)), messages_(std::move(messages)) {}

  [[nodiscard]] const std::string& tag() const { return tag_; }  ///< BCP 47
  /// A name or a sentence without values. Of the name of a path, "press SI11_L to BL50_L", its
  /// technique is said and the places stay.
  [[nodiscard]] std::string operator()(std::string_view words) const;
  /// A sentence by its key; its values are said as names are.
  [[nodiscard]] std::string operator()(const Sentence& one) const;
  /// All, in their order.
  [[nodiscard]] std::vector<std::string> operator()(const std::vector<Sentence>& all) const;
  /// A sentence whose English is its key.
  template <typename First, typename... Rest>
  [[nodiscard]] std::string operator()(fmt::format_string<First, Rest...> words, const First& first,
                                       const Rest&... rest) const {
    const fmt::string_view pattern = words;
    return (*this)(sentence<First, Rest...>(std::string(pattern.data(), pattern.size()), words,
                                            first, rest...));
  }

 private:
  [[nodiscard]] const std::string* message(std::string_view key) const;

  std::string tag_ = "en";
  Messages messages_;
};

}  // namespace tuina
