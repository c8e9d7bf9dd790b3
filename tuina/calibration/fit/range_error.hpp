// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/calibration/fit/joint_fit.hpp"

namespace tuina::calibration {

/// Depths for which a calibration states its range error.
inline constexpr double reported_depths_m[] = {0.65, 1.0, 1.75};

/// Expected RMS range error over the image at one depth.
struct RangeError {
  double systematic_m = 0.0;  ///< error of the calibration, constant over scans
  double random_m = 0.0;      ///< error from 0.1 px of line noise
  [[nodiscard]] double total_m() const;
};

/// Range error from the covariance of camera and light plane; nothing when the light plane is out
/// of view at that depth.
[[nodiscard]] std::optional<RangeError> expected_range_error(const Geometry& geometry,
                                                             const Covariance& covariance,
                                                             double depth_m);

/// Covariance to report: the row-wise one, enlarged where the jackknife over poses gives a larger
/// range error (errors within a pose correlate, as on bent paper).
[[nodiscard]] Covariance covariance_to_state(const JointFit& fit);

/// Camera, light plane and axis as a calibration; latency 0, couch from `base`.
[[nodiscard]] scanner::ScannerCalibration calibration_of(
    const Geometry& geometry, const scanner::ScannerCalibration& base = {});

}  // namespace tuina::calibration
