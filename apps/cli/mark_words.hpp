// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::app {

/// The marks of one kind (a colour of stickers, or bumps): levels from the head to the feet, each
/// one point of the midline or a pair, the person's left before the right.
struct MarkGroup {
  std::string kind;
  std::vector<std::vector<std::string>> levels;

  [[nodiscard]] std::size_t count() const;
};

/// The kinds that a recorded sweep in colour shows: the colours of stickers.
[[nodiscard]] std::vector<std::string> sticker_kinds();
/// The kind that a cloud shows.
inline constexpr const char* bump_kind = "bump";

/// What stands after --labels and --stickers: `magenta=SI11,BL47,BL50 yellow=GV4`. A name without a
/// side means the pair when the known names have one. Fails on unknown kinds and names, and on what
/// is named twice.
[[nodiscard]] Result<std::vector<MarkGroup>> parse_marks(const std::vector<std::string>& words,
                                                         const std::vector<std::string>& kinds,
                                                         const std::vector<std::string>& known,
                                                         const char* option);

}  // namespace tuina::app
