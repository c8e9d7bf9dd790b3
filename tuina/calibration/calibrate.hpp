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

/// Fewer poses with board and laser line do not make a calibration.
inline constexpr int min_poses = 8;

/// What pictures of boards give.
struct Calibrated {
  scanner::ScannerCalibration calibration;
  JointFit fit;
  int poses = 0;  ///< with board and laser line
  double reprojection_px = 0.0;
  double laser_rms_m = 0.0;
  double axis_rms_m = 0.0;  ///< of the corners of standing boards from where the axis puts them
  std::vector<std::optional<RangeError>> expected;  ///< at told_depths_m
  std::optional<Latency> latency;
  std::optional<CouchPose> couch;
  std::vector<std::string> remarks;  ///< what would make it better
};

/// Camera, light plane and yaw axis. Fails, with the cause and what to do, for every set that does
/// not determine them. Corners of standing boards in `views` are brought into one order.
[[nodiscard]] Result<Calibrated> calibrate(Views& views);

/// All of a folder of shots: `calibrate` of its boards, the latency of sweep_left and sweep_right
/// and the pose over the couch of couch, where they are there. `views` takes what was seen.
[[nodiscard]] Result<Calibrated> calibrate_folder(const std::filesystem::path& folder, Views& views,
                                                  const Progress& progress = {});

}  // namespace tuina::calibration
