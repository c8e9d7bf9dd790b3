// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "tuina/body/back_surface.hpp"

namespace tuina::body {

/// Whether the arms are up beside the head or down beside the trunk.
enum class Arms : std::uint8_t { up, down, unknown };
/// Name of it, as messages have it.
[[nodiscard]] constexpr const char* name_of(Arms arms) {
  return arms == Arms::up ? "up" : arms == Arms::down ? "down" : "unknown";
}

/// A point on the person's left and right; index with `left` and `right`.
using Sides = std::array<Vector2, 2>;
inline constexpr std::size_t left = 0;
inline constexpr std::size_t right = 1;

/// Outline of the back ([thesis] 5.3): the cloud projected onto the plane of the back, which is the
/// bed for a lying person and the inclined plane of the back for a sitting one. Frame `back` on
/// that plane: x to the person's left, y out of the back, z towards the head, origin half-way
/// between the shoulders. Plane coordinates are (x, z) of that frame, in metres.
struct Outline {
  Transform back_from_couch = Transform::Identity();
  Sides neck = {};                ///< corners where the neck meets the shoulders
  Sides shoulder = {};            ///< corners of the shoulders
  Sides trunk = {};               ///< sides of the trunk, two thirds down the midline
  Vector2 top = Vector2::Zero();  ///< upper end of the midline, on the shoulder line
  /// Lower end: 0.1 m above the seat; lying: top of the buttocks.
  Vector2 bottom = Vector2::Zero();
  Arms arms = Arms::unknown;
  double head_m = 0.0;  ///< height of the scan above the shoulders

  /// A place of the couch on the plane of the outline, m.
  [[nodiscard]] Vector2 plane(const Vector3& place_in_couch) const {
    const Vector3 p = back_from_couch * place_in_couch;
    return {p.x(), p.z()};
  }
};

/// Finds the outline. The plane comes from the back itself, or from the normal of a board that lay
/// on the couch before (board_plane.hpp), as in the thesis. Fails with the cause when the outline
/// is not that of a whole back.
[[nodiscard]] Result<Outline> find_outline(const BackSurface& back,
                                           const std::optional<Vector3>& board_normal = {});

}  // namespace tuina::body
