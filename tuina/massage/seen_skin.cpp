// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/seen_skin.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::massage {

Result<body::SurfacePoint> on_skin(const body::BackSurface& back, const Acupoint& point) {
  constexpr double off_skin_m = 20_mm;  // an acupoint farther from the scan is not on it
  body::SurfacePoint place = back.nearest(point.at_in_couch);
  const double off_m = (place.at_in_couch - point.at_in_couch).norm();
  if (!(off_m <= off_skin_m)) {
    return fail(Fault::not_found,
                "{} lies {:.0f} mm off the scanned skin, {:.0f} allowed; do scan and acupoints "
                "belong together?",
                point.name, to_mm(off_m), to_mm(off_skin_m));
  }
  // A person lies with the skin, not with the noise of the scan: the normal is that of the disc
  // which the tool presses on.
  constexpr double disc_m = 12_mm;
  Vector3 sum = place.normal_in_couch;
  const Vector3 first = place.normal_in_couch.unitOrthogonal();
  const Vector3 second = place.normal_in_couch.cross(first);
  for (int i = 0; i < 8; ++i) {
    const double theta = 2.0 * pi * i / 8;
    const Vector3 beside =
        place.at_in_couch + disc_m * (std::cos(theta) * first + std::sin(theta) * second);
    sum += back.nearest(beside).normal_in_couch;
  }
  place.normal_in_couch = sum.normalized();
  return place;
}

bool is_shown(const body::BackSurface& back, const ContactPath& path) {
  constexpr std::size_t stride = 10;
  const double beside_m = std::max(12_mm, 2.0 * back.spacing_m());
  for (std::size_t i = 0; i < path.points.size(); i += stride) {
    const Vector3& at = path.points[i].at_in_couch;
    if ((back.points().points[back.closest(at)] - at).norm() > beside_m) return false;
  }
  return true;
}

}  // namespace tuina::massage
