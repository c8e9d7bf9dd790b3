// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tuina/calibration/board/shots.hpp"
#include "tuina/calibration/board/views.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::calibration {

/// How a set of pictures is taken.
struct CaptureOptions {
  int poses = 12;  ///< of a board in somebody's hands, a multiple of 12
  int standing_boards = 3;
  bool sweeps = true;               ///< both ways over one still scene, for the latency
  double patience_s = 180.0;        ///< without a new picture, on the clock of the frames
  double standing_yaw_rad = 0.175;  ///< the unit turns by so much to both sides of zero
  double sweep_rad = 0.7, sweep_rad_per_s = 0.105;
};

/// What is going on, for who holds the board.
struct CaptureTold {
  int kept = 0, wanted = 0;  ///< poses, standing boards and sweeps
  std::string now;           ///< what to do
  std::string seen;          ///< what is wrong with the picture; empty where nothing is
  /// @{
  /// While a board is looked for: the newest picture, and the board in it where one was found.
  /// They last as long as the call.
  const Image* picture = nullptr;
  const SeenBoard* board = nullptr;
  /// @}
};

/// Leads through the pictures that a calibration needs (docs/calibration.md), into `folder`, as
/// `calibrate_folder` reads it: boards in the hand with and without the laser, kept once they are
/// held still, sharp, tilted as is still wanted, and crossed by the laser line; standing boards
/// before which the unit turns; a sweep each way. The laser is lit for moments only. What was kept
/// stays where this fails: Fault::device of camera and turntable, and when nobody shows a board for
/// too long; Fault::file. `tell` is called with each picture.
[[nodiscard]] Result<void> capture_shots(scanner::Camera& camera, scanner::Turntable& turntable,
                                         const Board& board, const std::filesystem::path& folder,
                                         const CaptureOptions& options,
                                         const std::function<void(const CaptureTold&)>& tell);

}  // namespace tuina::calibration
