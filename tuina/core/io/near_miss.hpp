// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tuina {

/// Levenshtein distance: letters to insert, delete or replace.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Hint for an unknown word: "is `rate_hz` meant?" when a known word is close, else "known: ..."
/// with the first of them.
[[nodiscard]] std::string suggestion(std::string_view given, const std::vector<std::string>& known);

}  // namespace tuina
