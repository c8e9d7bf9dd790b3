// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// Three far-apart points on the scan of a flat board placed where the back will be ([thesis] 5.3),
/// each the mean of its neighbourhood. Fails with too few or collinear points, or when the board is
/// not flat.
[[nodiscard]] Result<std::array<Vector3, 3>> three_places_of(const PointCloud& board_in_couch);

/// Unit normal of the plane through three points, away from the couch: upwards, or out of the back.
[[nodiscard]] Vector3 plane_normal(const std::array<Vector3, 3>& places);

}  // namespace tuina::body
