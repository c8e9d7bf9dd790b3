// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/line/laser_line.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::scanner {

/// One laser line, with its time on the camera's clock.
struct TimedLine {
  double time_s = 0.0;
  LaserLine line;
};

/// The newest profile of a running scan, for live display. Accurate to a few millimetres: no
/// outlier removal, provisional yaw.
struct LiveProfile {
  int number = 0;
  double yaw_rad = 0.0;
  std::vector<Vector3> points_in_couch;  ///< every fourth row
};

/// How the unit turns, and what it looks for.
struct SweepOptions {
  // 36 degrees see 0.70 m across at 1.1 m; speed step 9 of the AX-12A (0.111 rpm each) turns them
  // in 6 s.
  double from_rad = -18.0_deg;
  double to_rad = 18.0_deg;
  double speed_rad_per_s = 5.994_deg;
  double near_m = 0.3;  ///< depth range of the search, from the camera
  double far_m = 4.0;
  LineMethod method = LineMethod::likelihood;
  bool both_ways = false;        ///< also turn back over the scene
  double step_rad = 0.0;         ///< stop-and-shoot step; 0: continuous turn
  double max_lost_share = 0.05;  ///< maximum share of lost frames
  int expected_frames = 0;  ///< for the progress; 0: from the duration of the turn, at 30 frames/s
  std::function<void(const LiveProfile&)> on_profile;  ///< called during the scan
};

/// Comparison of forth and back sweep. The cloud is corrected for the latency error and the breath.
struct WaysCompared {
  double latency_error_s = 0.0;      ///< to be added to the latency of the calibration
  double latency_deviation_s = 0.0;  ///< standard deviation of latency_error_s
  double breath_m = 0.0;             ///< peak-to-peak breathing motion; 0: no breath found
  double breath_hz = 0.0;
  double disagreement_m = 0.0;  ///< RMS difference of the two ways along the line of sight
  double remaining_m = 0.0;     ///< the same after the corrections
};

/// A sweep as a cloud, with how it went.
struct Scan {
  PointCloud cloud_in_couch;  ///< with normals, amplitude and deviation
  /// Grid structure of the cloud: the points of frame i (both ways counted on) are
  /// first_of_frame[i] up to first_of_frame[i + 1], each in its image row. Grid neighbours are
  /// surface neighbours; gaps are holes.
  std::vector<std::size_t> first_of_frame;
  std::vector<std::uint16_t> rows;
  int profiles = 0;  ///< frames with a line
  int rows_lit = 0;  ///< over all frames, before mixed points are removed
  int ambiguous_rows = 0;
  double sweep_s = 0.0;     ///< from the first frame to the last
  double compute_ms = 0.0;  ///< line detection and cloud, without waiting for devices
  /// Expected RMS error along the normal from noise and calibration (a usual one, if it states no
  /// errors).
  double expected_error_m = 0.0;
  std::optional<WaysCompared> ways;  ///< set for a sweep forth and back
};

/// Interpolates yaw at frame times from coarse readings on a clock that lags by `latency_s`.
/// Standing at each frame: the reading then; else a straight line over the turn if the readings fit
/// one, or a local parabola. A hundred readings average out the motor's counts of 0.29 degrees.
[[nodiscard]] Result<std::vector<double>> yaw_at(std::span<const double> frame_times_s,
                                                 std::span<const YawReading> readings,
                                                 double latency_s);

/// Converts lines and readings to a cloud in `couch`: normals from the grid of profiles and rows,
/// mixed points at depth edges removed, holes kept. A point is drawn to where its nearest
/// neighbours see the surface, the more the noisier it is; its deviation is what is left, and
/// shared with them. A sweep forth and back is compared and corrected first. `compute_ms` is left
/// to the caller.
[[nodiscard]] Result<Scan> make_cloud(std::span<const TimedLine> lines,
                                      std::span<const YawReading> readings,
                                      const ScannerCalibration& calibration,
                                      double max_lost_share = SweepOptions{}.max_lost_share);

/// Turns the unit once and makes the cloud. Fails when a device fails, frames do not match the
/// calibration, the unit did not turn, or hardly any line is seen.
[[nodiscard]] Result<Scan> scan_sweep(Camera& camera, Turntable& turntable,
                                      const ScannerCalibration& calibration,
                                      const SweepOptions& options = {},
                                      const Progress& progress = {});

}  // namespace tuina::scanner
