// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "tuina/core/result.hpp"
#include "tuina/core/sentence.hpp"

namespace tuina::app {

/// A sentence as a page gets it: `words` in English, and what says it in another language.
[[nodiscard]] inline nlohmann::json shown_sentence(const Sentence& one) {
  return {{"words", one.words}, {"key", one.key}, {"values", one.values}};
}

/// An error as a sentence: in another language its kind alone is told.
[[nodiscard]] inline Sentence sentence_of(const Error& error) {
  constexpr std::array keys = {"fault_usage", "fault_not_found", "fault_bad_input", "fault_config",
                               "fault_file",  "fault_device",    "fault_stopped"};
  return {.words = error.message, .key = keys[static_cast<std::size_t>(error.fault)]};
}

/// Sentences of a line, or lines of sentences.
template <typename One>
[[nodiscard]] nlohmann::json shown_sentence(const std::vector<One>& all) {
  nlohmann::json shown = nlohmann::json::array();
  for (const One& one : all) shown.push_back(shown_sentence(one));
  return shown;
}

}  // namespace tuina::app
