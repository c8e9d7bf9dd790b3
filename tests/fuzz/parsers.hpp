// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tuina::test {

/// A parser of a file format that the scanner reads, and good files to begin with.
struct Parser {
  std::string name;
  std::vector<std::string> good;
  /// Whether the content is accepted. Ends the program when it is and what was read is not sound.
  std::function<bool(std::string_view content)> accepts;
};

[[nodiscard]] const std::vector<Parser>& parsers();

}  // namespace tuina::test
