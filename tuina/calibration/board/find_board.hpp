// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "tuina/calibration/board/shots.hpp"
#include "tuina/calibration/board/views.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::calibration {

/// The inner corners of a board to a few hundredths of a pixel. Nothing when it is not seen: of a
/// chessboard all of it, of a board with markers a handful of corners. Which of its corners is the
/// first a plain chessboard does not tell.
[[nodiscard]] std::optional<SeenBoard> find_board(ImageView image, const Board& board);

/// The camera and where each board stood, by Zhang's method [zhang2000]: the start of the joint
/// fit.
struct FirstCamera {
  scanner::CameraModel camera;
  std::vector<Transform> camera_from_board;  ///< one per view
};
[[nodiscard]] Result<FirstCamera> calibrate_camera(const Views& views);

}  // namespace tuina::calibration
