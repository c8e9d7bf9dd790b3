// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tuina {

/// How many letters must be put in, taken out or changed to make one word of the other.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Ends the sentence about an unknown word: "is `rate_hz` meant?" when one of the known words is
/// close to what was given, else "known: ..." with all of them.
[[nodiscard]] std::string suggestion(std::string_view given, const std::vector<std::string>& known);

}  // namespace tuina
