// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina {

/// Points of a surface in metres; the name of the variable says the frame (`scan_in_couch`). Each
/// property vector is empty or as long as `points`.
struct PointCloud {
  std::vector<Vector3> points;
  std::vector<Vector3> normals;    ///< unit, out of the surface
  std::vector<float> amplitude;    ///< brightness of the laser line, DN
  std::vector<float> deviation_m;  ///< standard deviation of the range

  [[nodiscard]] std::size_t size() const { return points.size(); }  ///< number of points
};

/// A triangulated surface in metres; triangles run counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace tuina
