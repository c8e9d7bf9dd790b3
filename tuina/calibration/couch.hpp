// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/calibration/latency.hpp"
#include "tuina/core/geometry.hpp"

namespace tuina::calibration {

/// Pose of the scanner over the couch.
struct CouchPose {
  Transform couch_from_camera = Transform::Identity();  ///< at yaw 0
  double tilt_deviation_rad = 0.0;
  double height_deviation_m = 0.0;
  double flatness_m = 0.0;  ///< RMS distance of the board's points from its plane
};

/// Height and tilt from a sweep over a flat board on the couch, whose upper face is z = 0 ([thesis]
/// 4.3). Heading, x and y are not observable and come from the sweep's nominal calibration. Fails
/// when that contradicts the measurement, or when the board is not flat, as with a wrong sign of
/// the yaw.
[[nodiscard]] Result<CouchPose> find_couch(const Sweep& sweep,
                                           const scanner::ScannerCalibration& measured);

/// Nominal pose without a board scan: the yaw axis upright through the origin, the camera
/// looking along -y.
[[nodiscard]] Transform couch_not_measured(const scanner::ScannerCalibration& measured);

}  // namespace tuina::calibration
