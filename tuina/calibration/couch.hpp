// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/calibration/latency.hpp"
#include "tuina/core/geometry.hpp"

namespace tuina::calibration {

/// The scanner over the couch.
struct CouchPose {
  Transform couch_from_camera = Transform::Identity();  ///< at yaw 0
  double tilt_deviation_rad = 0.0;
  double height_deviation_m = 0.0;
  double flatness_m = 0.0;  ///< RMS of the points of the board from the plane
};

/// Height and tilt from a sweep over a flat board on the couch, whose upper face is z = 0
/// ([thesis] 4.3); heading, x and y cannot be seen and are those of the nominal calibration that
/// lies with the sweep. Fails when the nominal one contradicts what was measured, or when the
/// board does not come out flat, as with a wrong sign of the yaw.
[[nodiscard]] Result<CouchPose> find_couch(const Sweep& sweep,
                                           const scanner::ScannerCalibration& measured);

/// What stands for it while no board on the couch was scanned: the yaw axis upright through the
/// origin, the camera looking along -y.
[[nodiscard]] Transform couch_not_measured(const scanner::ScannerCalibration& measured);

}  // namespace tuina::calibration
