// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tuina/body/learn/labelled_body.hpp"

namespace tuina::body {

/// Labelled bodies that are read by several threads, and each several times, so that learning holds
/// a few of them in memory. Numbers decide who is left out with whom: a body that keeps its number,
/// among as many, is learned from the same to the last bit.
struct BodySource {
  /// What of a body is needed: its skin and labels, or its scan as well, which may take long.
  enum class Needs : std::uint8_t { skin, scan };
  std::size_t count = 0;
  std::function<Result<LabelledBody>(std::size_t number, Needs needs)> read;
};

/// Bodies that are in memory; they must outlive the source.
[[nodiscard]] BodySource source_of(const std::vector<LabelledBody>& bodies);

}  // namespace tuina::body
