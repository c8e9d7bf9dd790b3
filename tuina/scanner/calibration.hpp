// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"

namespace tuina::scanner {

/// Pinhole camera with OpenCV's five distortion coefficients (k1, k2, p1, p2, k3); pixel centres
/// are integers. Camera frame: x to the right of the image, y down, z forward.
struct CameraModel {
  int width_px = 640;
  int height_px = 480;
  double fx_px = 1041.67;
  double fy_px = 1041.67;
  double cx_px = 319.5;
  double cy_px = 239.5;
  std::array<double, 5> distortion = {};
};

/// Standard deviations of a calibration. The defaults result from 40 poses of a chessboard with 0.1
/// px of noise (docs/scanner.md).
struct CalibrationErrors {
  /// Range error, RMS over the image, of camera and light plane together, at increasing depths.
  std::vector<double> depth_m = {0.65, 1.0, 1.75};
  std::vector<double> range_m = {0.35e-3, 0.56e-3, 1.06e-3};
  double axis_direction_rad = 0.5e-3;  ///< about each of two directions perpendicular to the axis
  double axis_point_m = 0.5e-3;        ///< along each of the same directions
  double latency_s = 2e-3;

  /// Expected error of a range at this depth from the camera.
  [[nodiscard]] double range_at_m(double depth_m) const;
};

/// Calibration of one scanner, as stored in calibration.toml.
struct ScannerCalibration {
  CameraModel camera;
  /// Light plane: points X with normal . X = distance, in the camera frame.
  Vector3 laser_normal_in_camera = Vector3::UnitX();
  double laser_distance_m = 0.2;
  /// Yaw axis; a positive yaw is right-handed about the direction.
  Vector3 axis_point_in_camera = Vector3::Zero();
  Vector3 axis_direction_in_camera = -Vector3::UnitY();
  double latency_s = 0.0;  ///< added to a yaw time to compare it with a frame time
  Transform couch_from_camera = Transform::Identity();  ///< at yaw 0
  std::optional<CalibrationErrors> errors;              ///< as stored in the file

  /// Camera pose after the unit has turned by `yaw_rad`.
  [[nodiscard]] Transform couch_from_camera_at(double yaw_rad) const;
};

/// Reads calibration.toml; only [standard_deviations] is optional. Fails with all faults, each with
/// file and line: unknown, missing and malformed keys, non-finite numbers, normals that are not
/// unit, matrices that are no rotations.
[[nodiscard]] Result<ScannerCalibration> read_calibration(const std::filesystem::path& path);
/// Reads a calibration from text; `name` stands in the message of a refusal.
[[nodiscard]] Result<ScannerCalibration> parse_calibration(std::string_view text,
                                                           std::string_view name);

/// Serialises a calibration; reading it back gives the same bits.
[[nodiscard]] std::string to_toml(const ScannerCalibration& calibration);

}  // namespace tuina::scanner
