// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// Three places far apart on the scan of a flat board that lies where the back will be
/// ([thesis] 5.3), each the mean of the points around it. Fails when there are too few points, when
/// they lie along one line, or when the board is not flat.
[[nodiscard]] Result<std::array<Vector3, 3>> three_places_of(const PointCloud& board_in_couch);

/// The unit normal of the plane through three places, on the side that looks away from the couch:
/// upwards, or out of the back.
[[nodiscard]] Vector3 plane_normal(const std::array<Vector3, 3>& places);

}  // namespace tuina::body
