// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/near_miss.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "tuina/core/io/text_lines.hpp"

namespace tuina {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = std::exchange(row[j + 1], std::min({change, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row.back();
}

std::string suggestion(std::string_view given, const std::vector<std::string>& known) {
  const auto nearest = std::min_element(known.begin(), known.end(), [&](auto& a, auto& b) {
    return edit_distance(a, given) < edit_distance(b, given);
  });
  if (nearest == known.end()) return "none is known";
  const std::size_t near_miss = 1 + nearest->size() / 3;
  if (edit_distance(*nearest, given) <= near_miss) return fmt::format("is `{}` meant?", *nearest);
  return fmt::format("known: {}", listed(known));
}

}  // namespace tuina
