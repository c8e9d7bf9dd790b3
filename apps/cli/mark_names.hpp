// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/cli/mark_words.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/scanner/stickers/sticker_watch.hpp"

namespace tuina::app {

/// Which sticker marks which point. Those of one colour are told apart by their level along the
/// spine, pairs by their side, in the frame that an atlas has found on this person. Fails when a
/// sticker is missing or too many, when the order cannot be told, and when a sticker lies where the
/// atlas would never expect its point.
[[nodiscard]] Result<std::map<std::string, scanner::Sticker>> name_stickers(
    const std::vector<scanner::Sticker>& stickers, const std::vector<StickerGroup>& groups,
    const body::Mapping& expected);

}  // namespace tuina::app
