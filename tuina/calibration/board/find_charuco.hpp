// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/calibration/board/views.hpp"
#include "tuina/core/image.hpp"

namespace tuina::calibration {

/// Detects the inner corners of a ChArUco board and identifies them by its markers; nothing with
/// fewer than two markers or eight corners. OpenCV's own detector comes in a Debian 12 package of
/// 329 MB only, so markers are decoded here.
[[nodiscard]] std::optional<SeenBoard> find_charuco(ImageView image, const Board& board);

}  // namespace tuina::calibration
