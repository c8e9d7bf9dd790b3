// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/check/expected_error.hpp"

#include <cmath>

namespace tuina::scanner {

ExpectedError::ExpectedError(const ScannerCalibration& calibration, double yaw_rad,
                             double yaw_rad_per_s)
    : errors_(calibration.errors.value_or(CalibrationErrors{})),
      yaw_rad_(yaw_rad),
      yaw_rad_per_s_(yaw_rad_per_s),
      axis_point_(calibration.couch_from_camera * calibration.axis_point_in_camera),
      axis_(calibration.couch_from_camera.linear() * calibration.axis_direction_in_camera) {
  const Transform couch_from_camera = calibration.couch_from_camera_at(yaw_rad);
  eye_ = couch_from_camera.translation();
  forward_ = couch_from_camera.linear().col(2);
}

double ExpectedError::variance_m2(const Vector3& at_in_couch, const Vector3& normal,
                                  double deviation_m) const {
  const auto square = [](double x) { return x * x; };
  const Vector3 sight = at_in_couch - eye_;
  // A range error moves the surface by its component along the normal.
  const double cosine2 = square(normal.dot(sight)) / sight.squaredNorm();
  const double range2 = square(errors_.range_at_m(sight.dot(forward_))) + square(deviation_m);
  // A time error e rotates the point by yaw speed times e.
  const Vector3 from_axis = at_in_couch - axis_point_;
  const double late2 =
      square(axis_.cross(from_axis).dot(normal) * yaw_rad_per_s_ * errors_.latency_s);
  // An axis shifted by d moves points by (1 - rotation) d; an axis tilted by t by yaw (t x r),
  // along the normal t . (r x n). Only d and t perpendicular to the axis count.
  const auto upright2 = [this, &square](const Vector3& v) {
    return v.squaredNorm() - square(axis_.dot(v));
  };
  const double aside2 =
      square(2.0 * std::sin(0.5 * yaw_rad_) * errors_.axis_point_m) * upright2(normal);
  const double tilted2 =
      square(yaw_rad_ * errors_.axis_direction_rad) * upright2(from_axis.cross(normal));
  return range2 * cosine2 + late2 + aside2 + tilted2;
}

}  // namespace tuina::scanner
