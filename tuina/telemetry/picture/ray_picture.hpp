// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "tuina/telemetry/picture/shaded_picture.hpp"

namespace tuina::telemetry {

/// The place of a scene that one ray of the eye meets, in the axes of the picture: x right, y up, z
/// towards the eye, metres.
struct Sample {
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, towards the eye
  Eigen::Vector3f albedo = Eigen::Vector3f::Zero();
  float cover = 1.F;  ///< below 1 where the seen region ends
  bool skin = false;  ///< false: a thread or a bead
};

/// A scene that light meets (Embree).
class RayPicture {
 public:
  /// Builds the tree of the scene's triangles.
  RayPicture(const Scene& scene, const Projection& projection);
  ~RayPicture();
  RayPicture(const RayPicture&) = delete;
  RayPicture& operator=(const RayPicture&) = delete;

  /// The foremost place that is seen through a point of the picture, in pixels.
  [[nodiscard]] std::optional<Sample> seen_through(float column, float row) const;

  /// Whether anything lies between a place and a light in this direction.
  [[nodiscard]] bool in_shadow(const Eigen::Vector3f& at, const Eigen::Vector3f& to_light) const;

 private:
  struct Geometry;
  std::unique_ptr<Geometry> geometry_;
};

}  // namespace tuina::telemetry
