// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/calibration/fit/light_plane.hpp"
#include "tuina/calibration/fit/yaw_axis.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::calibration {

/// Where the joint fit begins, and what it gives.
struct Geometry {
  scanner::CameraModel camera;
  LightPlane light;
  YawAxis axis;
  std::vector<Transform> camera_from_board;  ///< one per view
};

/// What the joint fit varies of camera, light plane and axis; the rows of its covariance.
enum Parameter : int {
  fx,
  fy,
  cx,
  cy,
  k1,
  k2,
  p1,
  p2,
  light_x,  ///< of normal / distance
  light_y,
  light_z,
  axis_tilt_1,  ///< of the direction, along two directions upright to it
  axis_tilt_2,
  axis_shift_1,  ///< of the point, along the same two
  axis_shift_2,
  parameters
};
using Covariance = Eigen::Matrix<double, parameters, parameters>;

/// How well one view agrees with the fit.
struct ViewResidual {
  double reprojection_px = 0.0;  ///< RMS over its corners
  double line_px = 0.0;          ///< RMS over the line on its board, across the line
  double line_m = 0.0;           ///< the same as distance from the light plane
  double line_share = 0.0;       ///< the same, of what the noise of the picture makes of it
  int line_points = 0;
};

struct JointFit {
  Geometry geometry;
  /// If every corner and row errs by itself; `calibrate` makes of it what is to be stated.
  Covariance covariance = Covariance::Zero();
  Covariance covariance_of_poses = Covariance::Zero();  ///< if whole poses err (jackknife)
  double corner_px = 0.0;                               ///< RMS of one coordinate of a corner
  double line_factor = 0.0;  ///< how much larger errors of the line are than its image noise says
  std::vector<ViewResidual> residuals;
};

/// The most likely camera, light plane, axis and board poses, all from all pictures at once
/// (Ceres): corners and lines in pixels, angles of the motor as coarse as its counts. A standing
/// board has one pose whatever the yaw. Fails when the pictures leave something undetermined.
[[nodiscard]] Result<JointFit> fit_jointly(const Views& views, const Geometry& start);

}  // namespace tuina::calibration
