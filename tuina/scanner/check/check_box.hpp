// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::scanner {

/// A box found in a scan, two or three of its faces seen.
struct FoundBox {
  std::array<double, 3> edges_m = {};  ///< in the order of the size that was looked for
  std::vector<double> angles_rad;      ///< between its faces: three of them, or one between two
  double flatness_m = 0.0;             ///< RMS of the points from the planes of their faces
  double border_m = 0.0;  ///< half the distance between points: so well is an edge's end known
  std::size_t points = 0;
  bool hollow = false;  ///< its faces meet in a corner seen from inside
};

/// The box of about this size in a scan (with normals): flat faces about upright to each other, no
/// larger than the box, meeting in an edge. Fails when there is none between half and twice the
/// size.
[[nodiscard]] Result<FoundBox> find_box(const PointCloud& cloud, const Vector3& size_m);

/// Refuses a scan whose box is hollow, off its size by more than 1 % and 2 mm, or whose faces meet
/// more than 2 degrees off the right angle: sign, scale or light plane of the calibration are
/// wrong.
[[nodiscard]] Result<FoundBox> check_box(const PointCloud& cloud, const Vector3& size_m);

}  // namespace tuina::scanner
