// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tuina/core/surface.hpp"

namespace tuina::sim {

/// Finds the point of a mesh that is closest to a given one: a tree of boxes, exact, no heap after
/// construction, one or two microseconds near the surface when the last answer is handed back as a
/// hint.
class ClosestPoint {
 public:
  /// A point of the mesh, in its triangle.
  struct Place {
    int triangle = -1;
    Vector3 at = Vector3::Zero();
    std::array<double, 3> weights = {};  ///< barycentric
    double distance_m = 0.0;
  };

  /// Asserts at least one triangle.
  explicit ClosestPoint(Mesh mesh);

  /// The mesh it was made of.
  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }
  /// The closest point; `hint_triangle` is that of the last answer nearby.
  [[nodiscard]] Place find(const Vector3& point, int hint_triangle = 0) const noexcept;

 private:
  struct Node {
    Vector3 low, high;
    int first = 0;  // leaf: index into order_; inner: left child, followed by the right one
    int count = 0;  // number of triangles; 0 in inner nodes
  };
  [[nodiscard]] Place on_triangle(int triangle, const Vector3& point) const noexcept;
  void split(int node, int first, int last, const std::vector<Vector3>& centres);

  Mesh mesh_;
  std::vector<Node> nodes_;
  std::vector<int> order_;
};

}  // namespace tuina::sim
