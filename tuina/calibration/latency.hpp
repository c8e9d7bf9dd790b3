// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/scanner/sweep.hpp"

namespace tuina::calibration {

/// One recorded sweep.
struct Sweep {
  std::vector<scanner::TimedLine> lines;
  std::vector<scanner::YawReading> readings;
  scanner::ScannerCalibration nominal;  ///< calibration.toml of the recording
};
/// Reads a recorded sweep and finds its laser lines; fails where the folder is no recording, or has
/// pictures of another size than the camera's.
[[nodiscard]] Result<Sweep> read_sweep(const std::filesystem::path& folder,
                                       const scanner::CameraModel& camera,
                                       const Progress& progress = {});

/// Time from a yaw reading to a frame, with its standard deviation.
struct Latency {
  double latency_s = 0.0;
  double deviation_s = 0.0;
};

/// Time to add to a yaw reading to compare it with a frame, from two sweeps of one still scene in
/// opposite directions: at equal yaw each image row must show the same. Independent of the rest of
/// the calibration. Fails when a sweep turns the wrong way or the scene is too flat.
[[nodiscard]] Result<Latency> find_latency(const Sweep& falling, const Sweep& rising);

}  // namespace tuina::calibration
