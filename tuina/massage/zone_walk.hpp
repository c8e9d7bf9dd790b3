// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "tuina/massage/technique/surface_curve.hpp"
#include "tuina/massage/zones.hpp"

namespace tuina::massage {

/// The zones that a technique passes along a curve.
struct ZoneWalk {
  std::set<Zone> touched;
  Zone strictest = Zone::muscle;  ///< Strictest of the allowed zones.
  Zone denied = Zone::muscle;     ///< A denied zone; muscle if none is denied.
  bool perhaps_spine = false;     ///< The spine cannot be ruled out on an allowed part.
  double from_m = 0.0;            ///< Beginning of the longest allowed stretch.
  double to_m = 0.0;              ///< End of it.
};

[[nodiscard]] ZoneWalk walk(const SurfaceCurve& curve, const ZoneMap& zones, Technique technique);

/// A part of a curve as an open curve.
[[nodiscard]] SurfaceCurve stretch_of(const SurfaceCurve& curve, double from_m, double to_m);

}  // namespace tuina::massage
