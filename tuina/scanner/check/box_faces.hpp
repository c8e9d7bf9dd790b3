// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::scanner {

/// A planar part of a scan.
struct Face {
  Vector3 normal = Vector3::UnitZ();  ///< towards the scanner
  double offset_m = 0.0;              ///< plane: normal . p = offset
  Vector3 middle = Vector3::Zero();
  std::vector<Vector3> points;
  double rms_m = 0.0;

  /// Distance of a place from the face, positive outside.
  [[nodiscard]] double out_m(const Vector3& point) const { return normal.dot(point) - offset_m; }
};

/// Planar parts of a scan (with normals), at most `max_width_m` wide, largest first.
[[nodiscard]] std::vector<Face> find_faces(const PointCloud& cloud, double max_width_m);

}  // namespace tuina::scanner
