// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/calibration/couch.hpp"
#include "tuina/calibration/fit/joint_fit.hpp"
#include "tuina/calibration/fit/range_error.hpp"
#include "tuina/calibration/latency.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::calibration {

/// Minimum number of poses with board and laser line.
inline constexpr int min_poses = 8;

/// Result of a calibration from pictures of boards.
struct Calibrated {
  scanner::ScannerCalibration calibration;
  JointFit fit;
  int poses = 0;  ///< with board and laser line
  double reprojection_px = 0.0;
  double laser_rms_m = 0.0;
  double axis_rms_m = 0.0;  ///< of the corners of standing boards from their predicted places
  std::vector<std::optional<RangeError>> expected;  ///< at reported_depths_m
  std::optional<Latency> latency;
  std::optional<CouchPose> couch;
  std::vector<std::string> remarks;  ///< advice for a better calibration
};

/// Calibrates camera, light plane and yaw axis. Fails with cause and remedy when the set does not
/// determine them. Reorders the corners of standing boards in `views` consistently.
[[nodiscard]] Result<Calibrated> calibrate(Views& views);

/// Calibrates from a folder of shots: `calibrate`, then the latency from sweep_left and sweep_right
/// and the couch pose from couch, where present. The measurements are returned in `views`.
[[nodiscard]] Result<Calibrated> calibrate_folder(const std::filesystem::path& folder, Views& views,
                                                  const Progress& progress = {});

}  // namespace tuina::calibration
