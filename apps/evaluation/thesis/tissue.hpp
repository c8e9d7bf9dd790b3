// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"

namespace tuina::app {

/// Chapter 6 of the thesis again, claim by claim: the laws of 6.1, the simulation of 6.3.1, the
/// seven subjects of 6.3.2. `json` is one object.
struct ThesisTissue {
  std::string text, json, html;
};
[[nodiscard]] Result<ThesisTissue> redo_thesis_tissue(std::uint64_t seed, const Progress& progress);

}  // namespace tuina::app
