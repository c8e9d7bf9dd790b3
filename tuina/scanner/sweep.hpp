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

/// One laser line: where it was seen, and when, on the camera's clock.
struct TimedLine {
  double time_s = 0.0;
  LaserLine line;
};

/// The newest profile of a scan that goes on, for those who draw the cloud while it grows. Its
/// place is to a few millimetres: noise is not judged yet, and the motor has not told all of its
/// turn.
struct LiveProfile {
  int number = 0;
  double yaw_rad = 0.0;
  std::vector<Vector3> points_in_couch;  ///< of every fourth row
};

struct SweepOptions {
  // 36 degrees see 0.70 m across at 1.1 m; speed step 9 of the AX-12A (0.111 rpm each) turns them
  // in 6 s.
  double from_rad = -18.0_deg;
  double to_rad = 18.0_deg;
  double speed_rad_per_s = 5.994_deg;
  double near_m = 0.3;  ///< what lies nearer or farther from the camera is not looked for
  double far_m = 4.0;
  LineMethod method = LineMethod::likelihood;
  bool both_ways = false;        ///< turn back over the same scene, too
  double step_rad = 0.0;         ///< stop and shoot in such steps; 0: one even turn
  double max_lost_share = 0.05;  ///< a sweep that lost more of its frames is refused
  int expected_frames = 0;  ///< for the progress; 0: from the duration of the turn, at 30 frames/s
  std::function<void(const LiveProfile&)> on_profile;  ///< called from within the scan
};

/// What the way forth and the way back, seen beside each other, tell. The cloud has the latency
/// error and the breath taken off.
struct WaysCompared {
  double latency_error_s = 0.0;      ///< to be added to the latency of the calibration
  double latency_deviation_s = 0.0;  ///< standard deviation of that
  double breath_m = 0.0;  ///< how far the person moves to and fro; 0 when no breath was found
  double breath_hz = 0.0;
  double disagreement_m = 0.0;  ///< RMS of one way against the other, along the sight
  double remaining_m = 0.0;     ///< the same once latency and breath are taken off
};

struct Scan {
  PointCloud cloud_in_couch;  ///< with normals, amplitude and deviation
  /// The grid of frames and rows in which the points were seen: those of frame i, both ways counted
  /// on, are first_of_frame[i] up to first_of_frame[i + 1], each in its row. Neighbours in it are
  /// neighbours on the surface, and a hole is a place that is missing.
  std::vector<std::size_t> first_of_frame;
  std::vector<std::uint16_t> rows;
  int profiles = 0;  ///< frames in which a line was seen
  int rows_lit = 0;  ///< over all frames, before points at depth edges are left out
  int ambiguous_rows = 0;
  double sweep_s = 0.0;  ///< from the first frame to the last
  double compute_ms =
      0.0;  ///< finding lines and making the cloud; waiting for the doors not counted
  /// RMS along the normal of what noise and the errors of the calibration cause; of a usual one
  /// where it does not tell them.
  double expected_error_m = 0.0;
  std::optional<WaysCompared> ways;  ///< when the unit turned forth and back
};

/// Yaw at the times of frames, from coarse readings on a clock that lags by the latency of the
/// calibration. Where the unit stood still for every frame, what the motor told then. Else a
/// straight line over the whole turn where the readings allow it, or a local one; in both cases a
/// hundred readings together know the angle far better than one count of the motor (0.29 degrees).
[[nodiscard]] Result<std::vector<double>> yaw_at(std::span<const double> frame_times_s,
                                                 std::span<const YawReading> readings,
                                                 double latency_s);

/// Lines and readings to a cloud in `couch`. The grid of profiles and rows gives normals and tells
/// the mixed points at depth edges, which are left out; holes stay holes. When the unit turned
/// forth and back, both ways are compared first. Leaves `compute_ms` to the caller.
[[nodiscard]] Result<Scan> make_cloud(std::span<const TimedLine> lines,
                                      std::span<const YawReading> readings,
                                      const ScannerCalibration& calibration,
                                      double max_lost_share = SweepOptions{}.max_lost_share);

/// Turns the unit once and makes the cloud of what it saw. Fails when a door fails, when the frames
/// do not belong to the calibration, when the unit did not turn, and when hardly any line is seen.
[[nodiscard]] Result<Scan> scan_sweep(Camera& camera, Turntable& turntable,
                                      const ScannerCalibration& calibration,
                                      const SweepOptions& options = {},
                                      const Progress& progress = {});

}  // namespace tuina::scanner
