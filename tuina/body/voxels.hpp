// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::body {

/// Points binned into cubes. Cubes are sorted by place, so that the order of the points does not
/// matter, and are found by their integer place.
struct Voxels {
  double size_m = 0.0;
  std::vector<std::array<int, 3>> place;
  std::vector<int> count;
  std::vector<Vector3> mean;
  std::vector<Matrix3> scatter;  ///< sum of (x - mean)(x - mean)^T

  /// Number of cubes that have points.
  [[nodiscard]] std::size_t size() const { return place.size(); }
  /// Index of the cube at a place; -1 if empty.
  [[nodiscard]] int at(const std::array<int, 3>& where) const;
  /// Index of the cube around a point; -1 if empty.
  [[nodiscard]] int around(const Vector3& point) const;

  std::vector<std::uint64_t> key;                 ///< sorted, one per cube
  std::vector<std::pair<std::int64_t, int>> row;  ///< (x, y) columns and their first cube, sorted
};

/// Bins points. Those beyond 16 km from the origin would overflow and must be refused before.
[[nodiscard]] Voxels gather(const std::vector<Vector3>& points, double size_m);

/// Connected components (26 neighbours), numbered from 0 by size, largest first.
struct Components {
  std::vector<int> of_voxel;
  std::vector<int> points;  ///< points of each component
};
[[nodiscard]] Components connect(const Voxels& voxels);

}  // namespace tuina::body
