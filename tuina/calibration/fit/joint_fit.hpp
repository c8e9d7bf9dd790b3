// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/calibration/fit/light_plane.hpp"
#include "tuina/calibration/fit/yaw_axis.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::calibration {

/// Start and result of the joint fit.
struct Geometry {
  scanner::CameraModel camera;
  LightPlane light;
  YawAxis axis;
  std::vector<Transform> camera_from_board;  ///< one per view
};

/// Free parameters of camera, light plane and axis; rows of the covariance.
enum Parameter : int {
  fx,
  fy,
  cx,
  cy,
  k1,
  k2,
  p1,
  p2,
  light_x,  ///< normal / distance
  light_y,
  light_z,
  axis_tilt_1,  ///< direction, along two vectors perpendicular to it
  axis_tilt_2,
  axis_shift_1,  ///< point, along the same two
  axis_shift_2,
  parameters
};
/// Covariance of the parameters, in the order of their enumeration.
using Covariance = Eigen::Matrix<double, parameters, parameters>;

/// Residuals of one view.
struct ViewResidual {
  double reprojection_px = 0.0;  ///< RMS over the corners
  double line_px = 0.0;          ///< RMS over the line on the board, across the line
  double line_m = 0.0;           ///< RMS distance from the light plane
  double line_share = 0.0;       ///< line residual relative to the image noise
  int line_points = 0;
};

/// What `fit_jointly` finds, with its errors.
struct JointFit {
  Geometry geometry;
  /// Assumes independent errors of corners and rows; `covariance_to_state` corrects it.
  Covariance covariance = Covariance::Zero();
  /// Assumes independent errors of poses (jackknife).
  Covariance covariance_of_poses = Covariance::Zero();
  double corner_px = 0.0;    ///< RMS of one coordinate of a corner
  double line_factor = 0.0;  ///< line residual relative to the image noise
  std::vector<ViewResidual> residuals;
};

/// Maximum-likelihood estimate of camera, light plane, axis and board poses from all pictures
/// (Ceres). Errors: corners and lines in pixels, motor angles in counts. A standing board has one
/// pose at all yaws. Fails when the pictures leave a parameter undetermined.
[[nodiscard]] Result<JointFit> fit_jointly(const Views& views, const Geometry& start);

}  // namespace tuina::calibration
