// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/calibration/fit/joint_fit.hpp"

namespace tuina::calibration {

/// Where a calibration tells the range error to expect.
inline constexpr double told_depths_m[] = {0.65, 1.0, 1.75};

/// RMS range error to expect over the image at one depth.
struct RangeError {
  double systematic_m = 0.0;  ///< of the calibration, the same in every scan
  double random_m = 0.0;      ///< of 0.1 px of noise of the line
  [[nodiscard]] double total_m() const;
};

/// From the covariance of camera and light plane; nothing when the light plane is not in view at
/// that depth.
[[nodiscard]] std::optional<RangeError> expected_range_error(const Geometry& geometry,
                                                             const Covariance& covariance,
                                                             double depth_m);

/// The covariance to state: that of the rows, made larger where leaving out poses changes the range
/// by more than it says. Rows of one pose then err alike, as over paper that is not flat.
[[nodiscard]] Covariance covariance_to_state(const JointFit& fit);

/// Camera, light plane and axis as a calibration; latency 0, couch as it is in `base`.
[[nodiscard]] scanner::ScannerCalibration calibration_of(
    const Geometry& geometry, const scanner::ScannerCalibration& base = {});

}  // namespace tuina::calibration
