// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tuina/core/contact.hpp"
#include "tuina/massage/technique/surface_curve.hpp"

namespace tuina::massage {

/// Moves a guide point, for instance around a place that must not be touched.
using Bend = std::function<Vector3(const Vector3& in_couch)>;

/// How a circle is rubbed.
struct RubOptions {
  double force_n = 15.0;
  double rate_hz = 0.35;    ///< Turns a second of a circle, or of a spiral where it is widest.
  int turns = 4;            ///< Turns of a circle; ways out or in again of a spiral.
  double radius_m = 0.030;  ///< Radius of a spiral.
};

/// The circle of [thesis] (3.21) on the skin around a place: drawn in the tangent plane, where
/// (3.21) tilts it about one axis only, then lifted. It begins towards `first_in_couch`; clockwise
/// is as seen from outside.
[[nodiscard]] Result<SurfaceCurve> circle_on(const body::BackSurface& back,
                                             const body::SurfacePoint& centre, double radius_m,
                                             const Vector3& first_in_couch, bool clockwise,
                                             const Bend& bend = {});

/// A spiral outwards from near a place to `radius_m`, its windings 9 mm apart: an open curve.
[[nodiscard]] Result<SurfaceCurve> spiral_on(const body::BackSurface& back,
                                             const body::SurfacePoint& centre, double radius_m,
                                             const Vector3& first_in_couch, bool clockwise,
                                             const Bend& bend = {});

/// Rubbing, [thesis] 3.5.2: whole turns of a closed curve at one speed and one force. The speed
/// along the skin stays below its bound whatever the rate. An open curve is gone along to and fro.
[[nodiscard]] ContactPath plan_rub(const SurfaceCurve& curve, const RubOptions& options,
                                   std::string name);

}  // namespace tuina::massage
