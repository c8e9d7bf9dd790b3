// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/core/random.hpp"

namespace tuina::tests {

/// The content with one to four faults as disks, editors and enemies make them: bytes changed,
/// lost, doubled, swapped for telling ones, or the end cut off. What a parser makes of it must be
/// an answer or an error.
inline std::string mutated(std::string content, Random& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const auto faults = 1 + below(4);
  for (std::size_t k = 0; k < faults && !content.empty(); ++k) {
    const std::size_t at = below(content.size());
    const std::size_t length = std::min(content.size() - at, 1 + below(12));
    constexpr std::string_view telling = "0919-+.e ,\n\r\t\"#x\xff\x00\x7f\x80";
    switch (below(6)) {
      case 0:
        content[at] = static_cast<char>(random());
        break;
      case 1:
        content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
        break;
      case 2:
        content.erase(at, length);
        break;
      case 3:
        content.insert(at, content.substr(below(content.size()), length));
        break;
      case 4:
        content.insert(at, 1, telling[below(telling.size())]);
        break;
      default:
        content.resize(at);
        break;
    }
  }
  return content;
}

}  // namespace tuina::tests
