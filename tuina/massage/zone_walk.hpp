// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "tuina/massage/technique/surface_curve.hpp"
#include "tuina/massage/zones.hpp"

namespace tuina::massage {

/// The zones that a technique passes along a curve.
struct ZoneWalk {
  std::set<Zone> touched;
  Zone strictest = Zone::muscle;  ///< of those that are allowed
  Zone denied = Zone::muscle;     ///< one that is denied; muscle if none is
  bool perhaps_spine = false;     ///< somewhere on the allowed parts
  double from_m = 0.0;            ///< the longest allowed stretch
  double to_m = 0.0;
};

[[nodiscard]] ZoneWalk walk(const SurfaceCurve& curve, const ZoneMap& zones, Technique technique);

/// A part of a curve as an open curve.
[[nodiscard]] SurfaceCurve stretch_of(const SurfaceCurve& curve, double from_m, double to_m);

}  // namespace tuina::massage
