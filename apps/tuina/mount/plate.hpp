// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::app {

/// A closed line of points in a plane, which does not cross itself.
using Outline = std::vector<Vector2>;

/// Something flat to print or to cut out, lying on z = 0.
struct Plate {
  std::string name;
  double thickness_m = 0.0;
  Outline outline;               ///< counterclockwise
  std::vector<Outline> windows;  ///< clockwise, within the outline, beside each other
};

/// A hole in which a shaft of that diameter turns: a polygon around the circle, clockwise.
[[nodiscard]] Outline round_hole(const Vector2& at, double diameter_m);
/// A slot from one middle of its round ends to the other, clockwise.
[[nodiscard]] Outline slot(const Vector2& from, const Vector2& to, double width_m);
/// Clockwise; its width lies along `along`, a unit vector.
[[nodiscard]] Outline rectangular_hole(const Vector2& middle, const Vector2& along, double width_m,
                                       double depth_m);

/// Area of the plate without its windows.
[[nodiscard]] double area_m2(const Plate& plate);

/// Corners of the outline and of all windows, one after the other, and triangles of these that
/// cover the plate, counterclockwise.
struct Covered {
  std::vector<Vector2> corners;
  std::vector<std::array<int, 3>> triangles;
};
[[nodiscard]] Covered cover(const Plate& plate);

/// The plate for a slicer, in millimetres: a closed surface of triangles, ASCII.
[[nodiscard]] std::string to_stl(const Plate& plate);
/// The plate for CAD, in millimetres: a solid with plane faces (AP214).
[[nodiscard]] std::string to_step(const Plate& plate);

}  // namespace tuina::app
