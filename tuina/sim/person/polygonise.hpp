// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "tuina/core/surface.hpp"

namespace tuina::sim {

struct Box {
  Vector3 low = Vector3::Zero();
  Vector3 high = Vector3::Zero();
};

/// The zero surface of a field that is negative inside and roughly a distance in metres outside, as
/// triangles of about the size of a cell (naive surface nets [gibson1998], the vertices then moved
/// onto the surface). The surface is open where it leaves the box. Only cells near the surface are
/// looked at.
[[nodiscard]] Mesh polygonise(const std::function<double(const Vector3&)>& field, const Box& box,
                              double cell_m);

/// The outward gradient of the field by central differences.
[[nodiscard]] Vector3 gradient_of(const std::function<double(const Vector3&)>& field,
                                  const Vector3& at);

/// The part of a mesh where `keep` (one number per vertex) is positive, cut straight through the
/// triangles at zero; of that the largest connected piece, without unused vertices.
[[nodiscard]] Mesh cut(const Mesh& mesh, const std::vector<double>& keep);

}  // namespace tuina::sim
