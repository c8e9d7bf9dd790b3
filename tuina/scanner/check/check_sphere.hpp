// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::scanner {

/// A ball found in a scan.
struct FoundSphere {
  Vector3 centre = Vector3::Zero();
  double diameter_m = 0.0;
  bool hollow = false;  ///< seen from inside: near and far, or left and right, are exchanged
  std::size_t points = 0;
  double rms_m = 0.0;  ///< RMS distance of its points from the sphere
};

/// Finds the ball of about this size with most points of a scan (with normals). Fails without one
/// between half and twice the size.
[[nodiscard]] Result<FoundSphere> find_sphere(const PointCloud& cloud, double diameter_m);

/// Fails when the scanned ball is hollow or off its size by more than 1 % and 2 mm: sign or scale
/// of the calibration are wrong.
[[nodiscard]] Result<FoundSphere> check_sphere(const PointCloud& cloud, double diameter_m);

}  // namespace tuina::scanner
