// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/surface.hpp"

namespace tuina::sim {

/// A finely meshed ball.
[[nodiscard]] Mesh ball_mesh(const Vector3& centre, double radius_m);

/// A box about its centre.
[[nodiscard]] Mesh box_mesh(const Vector3& middle, const Matrix3& turned, const Vector3& size_m);

/// Rotation that shows a scanner far along +y three faces of a box: an edge faces the view, tipped
/// to show the lid.
[[nodiscard]] Matrix3 corner_towards_y();

}  // namespace tuina::sim
