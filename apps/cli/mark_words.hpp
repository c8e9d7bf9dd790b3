// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/scanner/stickers/label_dots.hpp"

namespace tuina::app {

/// The stickers of one colour: levels from the head to the feet, each one point of the midline or a
/// pair, the person's left before the right.
struct StickerGroup {
  scanner::StickerColour colour = scanner::StickerColour::blue;
  std::vector<std::vector<std::string>> levels;

  [[nodiscard]] std::size_t count() const;
};

/// What stands after --labels and --stickers: `magenta=SI11,BL47,BL50 yellow=GV4`. A name without a
/// side means the pair when the known names have one. Fails on unknown colours and names, and on
/// what is named twice.
[[nodiscard]] Result<std::vector<StickerGroup>> parse_stickers(
    const std::vector<std::string>& words, const std::vector<std::string>& known,
    const char* option);

}  // namespace tuina::app
