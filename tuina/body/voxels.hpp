// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::body {

/// Points gathered in cubes of one size, in the order of their place in space, so that the order of
/// the points in the cloud carries no information. Cubes are found again by their whole-number
/// place.
struct Voxels {
  double size_m = 0.0;
  std::vector<std::array<int, 3>> place;
  std::vector<int> count;
  std::vector<Vector3> mean;
  std::vector<Matrix3> scatter;  ///< sum of (x - mean)(x - mean)^T

  [[nodiscard]] std::size_t size() const { return place.size(); }
  /// The index of the cube at a place; -1 where no point fell.
  [[nodiscard]] int at(const std::array<int, 3>& where) const;

  std::vector<std::uint64_t> key;                 ///< sorted, one for each cube
  std::vector<std::pair<std::int64_t, int>> row;  ///< (x, y) columns and their first cube, sorted
};

/// Points farther than 16 km from the origin would overflow the place; the caller has refused them.
[[nodiscard]] Voxels gather(const std::vector<Vector3>& points, double size_m);

/// A number for each cube: cubes that touch (26 neighbours) share it. Numbers run from 0 in order
/// of size, largest first.
struct Components {
  std::vector<int> of_voxel;
  std::vector<int> points;  ///< of each component
};
[[nodiscard]] Components connect(const Voxels& voxels);

}  // namespace tuina::body
