// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "tuina/core/geometry.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::sim {

/// A mesh that light meets (Embree). All questions may be asked from several threads at once.
class RayScene {
 public:
  explicit RayScene(const Mesh& mesh);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;
  ~RayScene();

  struct Hit {
    double distance_m = 0.0;
    Vector3 normal = Vector3::Zero();  ///< unit, of the triangle, on the side its corners turn left
  };
  /// The first surface along a ray; `direction` is unit.
  [[nodiscard]] std::optional<Hit> first_hit(const Vector3& origin, const Vector3& direction) const;

  /// Whether anything stands between two points.
  [[nodiscard]] bool blocks(const Vector3& from, const Vector3& to) const;

  /// How far a point is from the nearest place of the surface.
  [[nodiscard]] double distance_to(const Vector3& point) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace tuina::sim
