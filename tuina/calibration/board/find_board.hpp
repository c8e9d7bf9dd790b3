// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tuina/calibration/board/shots.hpp"
#include "tuina/calibration/board/views.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::calibration {

/// How hard a chessboard is looked for. Thorough takes ten times as long where there is none.
enum class Effort : std::uint8_t { quick, thorough };

/// Detects the inner corners of a board to a few hundredths of a pixel. A chessboard must be wholly
/// visible, of a board with markers a handful of corners suffices. The first corner of a plain
/// chessboard is ambiguous.
[[nodiscard]] std::optional<SeenBoard> find_board(ImageView image, const Board& board,
                                                  Effort effort = Effort::thorough);

/// Initial camera and board poses by Zhang's method [zhang2000], the start of the joint fit.
struct FirstCamera {
  scanner::CameraModel camera;
  std::vector<Transform> camera_from_board;  ///< one per view
};
[[nodiscard]] Result<FirstCamera> calibrate_camera(const Views& views);

}  // namespace tuina::calibration
