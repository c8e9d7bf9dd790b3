// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// Thins points to one for each cube of this size and estimates unoriented normals from the 27
/// cubes around each. Noisy skin fills several layers of cubes: it is projected onto the planes of
/// its neighbourhoods, and cubes with only noise tails are dropped.
[[nodiscard]] PointCloud thin_skin(const std::vector<Vector3>& points, double spacing_m);

}  // namespace tuina::body
