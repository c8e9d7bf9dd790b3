// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/scanner/check/check_box.hpp"
#include "tuina/scanner/check/check_sphere.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::app {

/// A scanner over the couch of one who lies as somebody built it, and what is known of it after
/// calibrating it from 40 poses of a board.
struct BuiltScanner {
  scanner::ScannerCalibration truth, believed;
};

/// With the errors that such a calibration leaves drawn by the seed: quick, and for walls only.
[[nodiscard]] std::vector<BuiltScanner> drawn_scanners(int count, std::uint64_t seed);

/// How a way from line to depth errs on a wall that stands upright to the camera.
struct DepthErrors {
  double rms_m = 0.0;
  double systematic_m = 0.0;  ///< RMS over the rows of what stays when the noise is averaged away
  double random_m = 0.0;      ///< RMS of the rest
};

/// One distance of [thesis] Fig. 4-9, each way averaged over several scanners as somebody built
/// them.
struct WallTrial {
  double depth_m = 0.0;
  DepthErrors nominal;       ///< (4.1)-(4.3) with the dimensions on the drawing
  DepthErrors fitted;        ///< (4.1) with f L and the edge fitted to three known walls
  DepthErrors ours;          ///< calibrated from 40 poses of a board
  double bound_px = 0.0;     ///< Cramer-Rao bound of the line at the amplitude seen
  double line_px = 0.0;      ///< standard deviation of the line, measured
  double predicted_m = 0.0;  ///< random depth error that the geometry makes of line_px
};

[[nodiscard]] std::vector<WallTrial> wall_trials(const std::vector<double>& depths_m,
                                                 const sim::LaserScannerOptions& options,
                                                 std::span<const BuiltScanner> scanners,
                                                 std::uint64_t seed);

/// What may go wrong in a scan of a person.
struct ScanConditions {
  sim::LaserScannerOptions options;
  sim::Breathing breathing;
  double latency_error_s = 0.0;  ///< error of the latency in the calibration
  bool upright = true;           ///< the mount: 640 rows along the spine, or 480
  scanner::SweepOptions sweep;
};

struct BackTrial {
  double rms_m = 0.0;
  double bias_m = 0.0;          ///< mean error, outward
  double expected_m = 0.0;      ///< error that the scan itself expects
  double outlier_share = 0.0;   ///< farther than 5 mm from the surface
  double seen_share = 0.0;      ///< share of the places seen by both laser and camera
  double covered_points = 0.0;  ///< share of the acupoints with a point of the scan within 6 mm
  bool refused = false;
};

/// Scans of phantoms' backs from 1.1 m; RMS over all of them. The scanners take turns; without any,
/// they are as drawn and their calibrations have errors drawn by the seed. Heading, x and y over
/// the couch, which no calibration finds, are set right.
[[nodiscard]] BackTrial back_trial(const ScanConditions& conditions, int people, std::uint64_t seed,
                                   std::span<const BuiltScanner> scanners = {});

/// One scan of a body in the air, 1 m before the scanner that looks at one who sits.
[[nodiscard]] Result<PointCloud> scan_of_body(const Mesh& body_in_couch,
                                              const sim::LaserScannerOptions& options,
                                              std::uint64_t seed);

/// The box of the thesis, 150 x 150 x 200 mm, a corner towards the scanner.
struct BoxTrial {
  PointCloud cloud;
  scanner::FoundBox found;
};
[[nodiscard]] Result<BoxTrial> box_trial(const sim::LaserScannerOptions& options,
                                         std::uint64_t seed);

/// A ball of 150 mm.
struct SphereTrial {
  PointCloud cloud;
  scanner::FoundSphere found;
};
[[nodiscard]] Result<SphereTrial> sphere_trial(const sim::LaserScannerOptions& options,
                                               std::uint64_t seed);

}  // namespace tuina::app
