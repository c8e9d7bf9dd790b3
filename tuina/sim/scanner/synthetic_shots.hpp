// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/sim/scanner/board_renderer.hpp"

namespace tuina::sim {

/// A scanner as somebody built it: over the couch, looking down, every part a little off its
/// drawing. The camera stands upright, or else its rows lie across the spine.
[[nodiscard]] scanner::ScannerCalibration built_scanner(std::uint64_t seed, bool upright = true);

/// A ChArUco board that fits a sheet of A4, 5 x 7 squares of OpenCV's DICT_4X4_50.
[[nodiscard]] inline scanner::Board charuco_board() {
  return {.columns = 4, .rows = 6, .square_m = 0.035, .marker_m = 0.026};
}

struct RehearsalOptions {
  scanner::Board board;
  int poses = 40;          ///< of a board held in the hand, each with and without laser
  int standing_poses = 8;  ///< of a board that stands while the unit turns
  double nearest_m = 0.5;
  double max_distance_m = 1.75;
  bool sweeps = true;  ///< sweep_left, sweep_right and couch as well
  int threads = 2;
};

/// One picture of a set: what is in it, and where the board truly is.
struct RehearsalPicture {
  bool laser = false;
  int pose = 0;
  double yaw_rad = 0.0;  ///< as the motor tells it, in its counts
  Transform camera_from_board = Transform::Identity();
};
[[nodiscard]] std::vector<RehearsalPicture> rehearsal_pictures(
    const scanner::ScannerCalibration& truth, std::uint64_t seed,
    const RehearsalOptions& options = {});

/// Photographs a whole set of calibration shots with that scanner into a new folder, as `tuina
/// calibrate` reads it. What is true of the scanner is not in it. The folder appears when it is
/// whole.
[[nodiscard]] Result<void> rehearse_calibration(const scanner::ScannerCalibration& truth,
                                                std::uint64_t seed,
                                                const std::filesystem::path& folder,
                                                const RehearsalOptions& options = {},
                                                const Progress& progress = {});

}  // namespace tuina::sim
