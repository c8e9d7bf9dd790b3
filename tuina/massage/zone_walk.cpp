// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/zone_walk.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::massage {
namespace {

constexpr double pace_m = 1_mm;

}  // namespace

ZoneWalk walk(const SurfaceCurve& curve, const ZoneMap& zones, Technique technique) {
  ZoneWalk found;
  double start_m = 0.0;
  const int paces = static_cast<int>(std::ceil(curve.length_m() / pace_m));
  for (int i = 0; i <= paces; ++i) {
    const double way_m = std::min(i * pace_m, curve.length_m());
    const Vector3 at = curve.at(way_m).at_in_couch;
    const Zone zone = zones.in_lane(at, technique);
    if (cap_n(zone, technique) <= 0.0) {
      found.denied = zone;
      start_m = way_m + pace_m;
      continue;
    }
    found.touched.insert(zone);
    found.perhaps_spine = found.perhaps_spine || zones.perhaps_spine(at);
    if (cap_n(zone, technique) < cap_n(found.strictest, technique)) found.strictest = zone;
    if (way_m - start_m > found.to_m - found.from_m) {
      found.from_m = start_m;
      found.to_m = way_m;
    }
  }
  return found;
}

SurfaceCurve stretch_of(const SurfaceCurve& curve, double from_m, double to_m) {
  std::vector<body::SurfacePoint> points;
  const int paces = std::max(3, static_cast<int>(std::ceil((to_m - from_m) / (2.0 * pace_m))));
  for (int i = 0; i <= paces; ++i) {
    points.push_back(curve.at(from_m + (to_m - from_m) * i / paces));
  }
  return SurfaceCurve(points, false);
}

}  // namespace tuina::massage
