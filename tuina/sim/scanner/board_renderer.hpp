// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"
#include "tuina/core/random.hpp"
#include "tuina/scanner/board.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::sim {

/// Exposure of a picture of a board.
struct BoardLight {
  double white_dn = 190.0;
  double black_dn = 32.0;
  double behind_dn = 80.0;  ///< wall behind the board
  double laser_dn = 0.0;    ///< line on white at 1.1 m; 0: laser off
  double noise_dn = 2.0;    ///< noise of one pixel
};

/// Bright enough for the corners, laser off.
[[nodiscard]] inline BoardLight board_exposure() {
  return {};
}
/// Dark enough for the line.
[[nodiscard]] inline BoardLight laser_exposure() {
  return {.white_dn = 26.0, .black_dn = 8.0, .behind_dn = 14.0, .laser_dn = 200.0, .noise_dn = 4.0};
}

/// Picture of a board before a wall: blurred by lens and pixels, lit from one side, with the laser
/// line on board and wall.
[[nodiscard]] Image photograph(const scanner::ScannerCalibration& truth,
                               const scanner::Board& board, const Transform& camera_from_board,
                               const BoardLight& light, Random& random);

/// True when the whole board with its white rim is in the picture and faces the camera; for a board
/// with markers, two thirds of the corners.
[[nodiscard]] bool in_view(const scanner::CameraModel& camera, const scanner::Board& board,
                           const Transform& camera_from_board);

}  // namespace tuina::sim
