// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "tuina/core/surface.hpp"

namespace tuina::sim {

struct Box {
  Vector3 low = Vector3::Zero();
  Vector3 high = Vector3::Zero();
};

/// Triangulates the zero surface of a field that is negative inside and roughly a distance (m)
/// outside: naive surface nets [gibson1998] with vertices projected onto the surface. Open where
/// the surface leaves the box. Only cells near the surface are evaluated.
[[nodiscard]] Mesh polygonise(const std::function<double(const Vector3&)>& field, const Box& box,
                              double cell_m);

/// Outward gradient of a field by central differences.
[[nodiscard]] Vector3 gradient_of(const std::function<double(const Vector3&)>& field,
                                  const Vector3& at);

/// The part of a mesh where `keep` (one number per vertex) is positive, triangles cut at zero; its
/// largest connected piece, without unused vertices.
[[nodiscard]] Mesh cut(const Mesh& mesh, const std::vector<double>& keep);

}  // namespace tuina::sim
