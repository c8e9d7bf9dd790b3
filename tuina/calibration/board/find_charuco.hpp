// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/calibration/board/views.hpp"
#include "tuina/core/image.hpp"

namespace tuina::calibration {

/// The inner corners of a ChArUco board that are in the picture, wherever its markers tell which
/// they are; nothing with fewer than two markers or eight corners. Debian 12 has OpenCV's own
/// finder in a package of 329 MB only, so the markers are read here.
[[nodiscard]] std::optional<SeenBoard> find_charuco(ImageView image, const Board& board);

}  // namespace tuina::calibration
