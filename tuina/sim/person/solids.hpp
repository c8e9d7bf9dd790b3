// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/surface.hpp"

namespace tuina::sim {

/// A ball, finely meshed.
[[nodiscard]] Mesh ball_mesh(const Vector3& centre, double radius_m);

/// A box about its middle.
[[nodiscard]] Mesh box_mesh(const Vector3& middle, const Matrix3& turned, const Vector3& size_m);

/// The turn that shows a scanner far along +y three faces of a box: an edge upright to the sight,
/// then tipped so that the lid shows.
[[nodiscard]] Matrix3 corner_towards_y();

}  // namespace tuina::sim
