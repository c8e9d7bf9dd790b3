// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::scanner {

/// A box found in a scan, with two or three visible faces.
struct FoundBox {
  std::array<double, 3> edges_m = {};  ///< in the order of the nominal size
  std::vector<double> angles_rad;      ///< between its faces: three, or one between two
  double flatness_m = 0.0;  ///< RMS distance of the points from the planes of their faces
  double border_m = 0.0;    ///< half the point spacing: uncertainty of an edge's end
  std::size_t points = 0;
  bool hollow = false;  ///< the corner is seen from inside
};

/// Finds a box of about this size in a scan (with normals): perpendicular flat faces, no larger
/// than the box, meeting in an edge. Fails without one between half and twice the size.
[[nodiscard]] Result<FoundBox> find_box(const PointCloud& cloud, const Vector3& size_m);

/// Fails when the scanned box is hollow, off its size by more than 1 % and 2 mm, or more than 2
/// degrees off the right angle: sign, scale or light plane of the calibration are wrong.
[[nodiscard]] Result<FoundBox> check_box(const PointCloud& cloud, const Vector3& size_m);

}  // namespace tuina::scanner
