// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/scanner/calibration.hpp"

namespace tuina::scanner {

/// Error propagation from calibration and line noise to the points of one profile.
class ExpectedError {
 public:
  /// `yaw_rad_per_s`: turning speed of the unit at that profile.
  ExpectedError(const ScannerCalibration& calibration, double yaw_rad, double yaw_rad_per_s);

  /// Error variance along the normal, for a point with the given range deviation.
  [[nodiscard]] double variance_m2(const Vector3& at_in_couch, const Vector3& normal,
                                   double deviation_m) const;

 private:
  CalibrationErrors errors_;
  double yaw_rad_;
  double yaw_rad_per_s_;
  Vector3 eye_, forward_, axis_point_, axis_;  // in couch
};

}  // namespace tuina::scanner
