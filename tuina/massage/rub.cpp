// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/rub.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/massage/contact_path.hpp"

namespace tuina::massage {

Result<SurfaceCurve> circle_on(const body::BackSurface& back, const body::SurfacePoint& centre,
                               double radius_m, const Vector3& first_in_couch, bool clockwise,
                               const Bend& bend) {
  const Vector3& n = centre.normal_in_couch;
  const Vector3 first = (first_in_couch - first_in_couch.dot(n) * n).normalized();
  const Vector3 second = clockwise ? first.cross(n) : n.cross(first);
  constexpr int points = 72;
  std::vector<Vector3> guide;
  for (int i = 0; i < points; ++i) {
    const double theta = 2.0 * pi * i / points;
    const Vector3 on_circle =
        centre.at_in_couch + radius_m * (std::cos(theta) * first + std::sin(theta) * second);
    guide.push_back(bend ? bend(on_circle) : on_circle);
  }
  const auto lifted = lift(back, guide, std::vector<Vector3>(guide.size(), n));
  if (!lifted) return tl::unexpected(lifted.error());
  return SurfaceCurve(*lifted, true);
}

ContactPath plan_rub(const SurfaceCurve& circle, const RubOptions& options, std::string name) {
  const double kept_n = std::min(kept_force_n, options.force_n);
  const double rubbed_n = options.force_n - kept_n;
  const double rise_s = force_ramp_s(rubbed_n, 0.6);
  const Slide slide{
      .length_m = options.turns * circle.length_m(),
      .speed_m_per_s = std::min(options.rate_hz * circle.length_m(), fastest_slide_m_per_s),
      .ramp_s = std::max(0.6, rise_s)};
  const double moving_s = slide.duration_s();
  const double duration_s = 2.0 * landing_s + moving_s;
  return sampled(std::move(name), Technique::rub, duration_s, [&](double t) {
    const double since = t - landing_s;
    const body::SurfacePoint point = circle.at(slide.way_m(since));
    const double touch =
        smooth_step(t, landing_s) - smooth_step(t - (duration_s - landing_s), landing_s);
    const double rub =
        smooth_step(since, rise_s) - smooth_step(since - (moving_s - rise_s), rise_s);
    return ContactPoint{.at_in_couch = point.at_in_couch,
                        .normal_in_couch = point.normal_in_couch,
                        .force_n = kept_n * touch + rubbed_n * rub};
  });
}

}  // namespace tuina::massage
