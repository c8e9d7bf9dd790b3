// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// Thins points to one for each cube of this size and estimates unoriented normals from the 27
/// cubes around each. Noisy skin fills several layers of cubes: it is projected onto the planes of
/// its neighbourhoods, and cubes with only noise tails are dropped.
/// Error `bad_input`: much of the skin is there twice, one layer over the other, as when a person
/// moves between two sweeps that are joined.
[[nodiscard]] Result<PointCloud> thin_skin(const std::vector<Vector3>& points, double spacing_m);

}  // namespace tuina::body
