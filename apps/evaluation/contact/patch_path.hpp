// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "tuina/core/contact.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/technique/press.hpp"

namespace tuina::app {

/// The patch of skin of a contact experiment as it is believed: where it is, and how it is bent
/// about its upright axis.
struct BelievedPatch {
  Vector3 centre_in_couch = Vector3(0.165, 0.03, 0.42);
  Vector3 normal_in_couch = Vector3::UnitY();
  double bend_radius_m = std::numeric_limits<double>::infinity();
};

/// The way of a rub: a circle of 30 mm at 0.5 Hz; an ellipse of 90 by 40 mm, or a spiral from 6 mm
/// to 30 mm and in again, both at 66 mm/s.
enum class RubShape : std::uint8_t { circle, ellipse, spiral };

/// What is done there. A stroke is 250 mm at 50 mm/s. A technique that goes in circles has the
/// radius and rate that a programme has by default; only a rub has the shapes above, which no
/// programme can order. On a person, room `massage` lays paths on the scanned surface instead.
struct PatchTask {
  Technique technique = Technique::press;
  double force_n = 30.0;
  double duration_s = 10.0;  ///< a stroke takes as long as its way
  massage::PressWindow window = {};
  bool stroke_across = false;  ///< over the bend instead of along it
  RubShape rub_shape = RubShape::circle;
  double tap_hz = 3.0;
};

[[nodiscard]] ContactPath path_on(const BelievedPatch& patch, const PatchTask& task);

}  // namespace tuina::app
