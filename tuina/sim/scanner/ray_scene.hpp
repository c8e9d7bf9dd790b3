// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "tuina/core/geometry.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::sim {

/// Ray tracing and distances on a mesh (Embree). Thread-safe.
class RayScene {
 public:
  /// A copy of the mesh is kept, sorted.
  explicit RayScene(const Mesh& mesh);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;
  ~RayScene();

  /// Where a ray meets the mesh.
  struct Hit {
    double distance_m = 0.0;
    Vector3 normal = Vector3::Zero();  ///< unit normal of the triangle, by the right-hand rule
  };
  /// First intersection of a ray; `direction` is unit.
  [[nodiscard]] std::optional<Hit> first_hit(const Vector3& origin, const Vector3& direction) const;

  /// True when the segment between two points is obstructed.
  [[nodiscard]] bool blocks(const Vector3& from, const Vector3& to) const;

  /// Distance of a point from the surface; negative behind the nearest triangle.
  [[nodiscard]] double height_over(const Vector3& point) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace tuina::sim
