// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/json_fault.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tuina/core/io/text_lines.hpp"

namespace tuina {
namespace {

using nlohmann::json;

std::string with_article(std::string_view kind) {
  if (kind == "null") return "null";
  const bool vowel = kind.starts_with('o') || kind.starts_with('a');
  return fmt::format("{} {}", vowel ? "an" : "a", kind);
}

/// The words of the library's sentence behind `before`, up to the next comma.
std::string_view word_behind(std::string_view sentence, std::string_view before) {
  const std::size_t at = sentence.find(before);
  if (at == std::string_view::npos) return "another value";
  const std::string_view rest = sentence.substr(at + before.size());
  return rest.substr(0, rest.find(','));
}

std::string misfit(const json::exception& fault) {
  // The numbers of the library's exceptions are part of its documented interface.
  constexpr int wrong_kind = 302;
  constexpr int too_short = 401;
  constexpr int no_key = 403;
  constexpr int too_large = 406;
  const std::string_view sentence = fault.what();
  if (fault.id == no_key) {
    const std::size_t begin = sentence.find('\'') + 1;
    const std::size_t end = std::max(begin, sentence.rfind('\''));
    return in_quotes(sentence.substr(begin, end - begin)) + " is missing";
  }
  if (fault.id == wrong_kind) {
    return fmt::format("{} stands where {} is needed",
                       with_article(word_behind(sentence, "but is ")),
                       with_article(word_behind(sentence, "must be ")));
  }
  if (fault.id == too_short) return "a list is too short";
  if (fault.id == too_large) return "a number is too large";
  return "an object with keys is needed where another value stands";
}

}  // namespace

Error json_fault(const std::exception& fault, std::string_view text, std::string_view name,
                 std::string_view wanted) {
  if (only_white_space(text))
    return {Fault::bad_input, fmt::format("{}: is empty; JSON with {} is needed", name, wanted)};
  if (const auto* wrong = dynamic_cast<const json::parse_error*>(&fault)) {
    const std::size_t at = std::min(text.size(), wrong->byte > 0 ? wrong->byte - 1 : 0);
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    if (at == text.size())
      return {Fault::bad_input, fmt::format("{}:{}: the JSON ends too early", name, line)};
    const std::string_view rest = text.substr(at, text.find('\n', at) - at);
    return {Fault::bad_input, fmt::format("{}:{}: not JSON from {} on; a comma, bracket or quote "
                                          "is missing or too many",
                                          name, line, in_quotes(rest))};
  }
  const auto* misfitting = dynamic_cast<const json::exception*>(&fault);
  return {Fault::bad_input,
          fmt::format("{}: is not {}: {}", name, wanted,
                      misfitting != nullptr ? misfit(*misfitting) : fault.what())};
}

}  // namespace tuina
