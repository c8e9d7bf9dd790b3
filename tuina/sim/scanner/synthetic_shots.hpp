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

/// A scanner with building tolerances, over the couch, looking down. `upright`: image rows along
/// the spine's direction; else across.
[[nodiscard]] scanner::ScannerCalibration built_scanner(std::uint64_t seed, bool upright = true);

/// A ChArUco board on a sheet of A4, 5 x 7 squares of OpenCV's DICT_4X4_50.
[[nodiscard]] inline scanner::Board charuco_board() {
  return {.columns = 4, .rows = 6, .square_m = 0.035, .marker_m = 0.026};
}

struct SyntheticShotsOptions {
  scanner::Board board;
  int poses = 40;          ///< hand-held board poses, each with and without laser
  int standing_poses = 8;  ///< poses of boards that stand while the unit turns
  double nearest_m = 0.5;
  double max_distance_m = 1.75;
  double line_share = 1.0;  ///< of the usual brightness of the laser line on the board
  bool sweeps = true;       ///< also sweep_left, sweep_right and couch
  int threads = 2;
};

/// One picture of a set, with the true board pose.
struct SyntheticPicture {
  bool laser = false;
  int pose = 0;
  double yaw_rad = 0.0;  ///< motor reading, in counts
  Transform camera_from_board = Transform::Identity();
};
[[nodiscard]] std::vector<SyntheticPicture> synthetic_pictures(
    const scanner::ScannerCalibration& truth, std::uint64_t seed,
    const SyntheticShotsOptions& options = {});

/// Renders a set of calibration shots into a new folder, as `tuina calibrate` reads it, without the
/// ground truth. The folder appears when it is complete.
[[nodiscard]] Result<void> render_calibration_shots(const scanner::ScannerCalibration& truth,
                                                    std::uint64_t seed,
                                                    const std::filesystem::path& folder,
                                                    const SyntheticShotsOptions& options = {},
                                                    const Progress& progress = {});

}  // namespace tuina::sim
