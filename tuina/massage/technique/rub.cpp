// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/rub.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {

namespace {

/// Axes of the tangent plane: towards the first point, and the way round.
struct Axes {
  Vector3 first, second;
};

Axes axes_at(const body::SurfacePoint& centre, const Vector3& first_in_couch, bool clockwise) {
  const Vector3& n = centre.normal_in_couch;
  const Vector3 first = (first_in_couch - first_in_couch.dot(n) * n).normalized();
  return {first, clockwise ? first.cross(n) : n.cross(first)};
}

Vector3 around(const body::SurfacePoint& centre, const Axes& axes, double radius_m, double theta) {
  return centre.at_in_couch +
         radius_m * (std::cos(theta) * axes.first + std::sin(theta) * axes.second);
}

Result<SurfaceCurve> lifted_curve(const body::BackSurface& back, const body::SurfacePoint& centre,
                                  std::vector<Vector3> guide, bool closed, const Bend& bend) {
  if (bend) {
    for (Vector3& point : guide) point = bend(point);
  }
  const auto lifted = lift(back, guide, std::vector<Vector3>(guide.size(), centre.normal_in_couch));
  if (!lifted) return tl::unexpected(lifted.error());
  return SurfaceCurve(*lifted, closed);
}

}  // namespace

Result<SurfaceCurve> circle_on(const body::BackSurface& back, const body::SurfacePoint& centre,
                               double radius_m, const Vector3& first_in_couch, bool clockwise,
                               const Bend& bend) {
  const Axes axes = axes_at(centre, first_in_couch, clockwise);
  constexpr int points = 72;
  std::vector<Vector3> guide;
  guide.reserve(points);
  for (int i = 0; i < points; ++i) {
    guide.push_back(around(centre, axes, radius_m, 2.0 * pi * i / points));
  }
  return lifted_curve(back, centre, std::move(guide), true, bend);
}

Result<SurfaceCurve> spiral_on(const body::BackSurface& back, const body::SurfacePoint& centre,
                               double radius_m, const Vector3& first_in_couch, bool clockwise,
                               const Bend& bend) {
  constexpr double innermost_m = 6_mm, winding_m = 9_mm, step_m = 3_mm;
  const Axes axes = axes_at(centre, first_in_couch, clockwise);
  const double max_m = std::max(radius_m, innermost_m + winding_m);
  std::vector<Vector3> guide;
  double theta = 0.0, r = innermost_m;
  while (r < max_m) {
    guide.push_back(around(centre, axes, r, theta));
    theta += step_m / r;
    r = innermost_m + winding_m * theta / (2.0 * pi);
  }
  return lifted_curve(back, centre, std::move(guide), false, bend);
}

ContactPath plan_rub(const SurfaceCurve& curve, const RubOptions& options, std::string name) {
  const double kept_n = std::min(kept_force_n, options.force_n);
  const double rubbed_n = options.force_n - kept_n;
  const double rise_s = force_ramp_s(rubbed_n, 0.6);
  // A circle is one way of several turns; a spiral is as many ways, every second one back.
  const int ways = curve.closed() ? 1 : options.turns;
  const double round_m = curve.closed() ? curve.length_m() : 2.0 * pi * options.radius_m;
  const Slide slide{.length_m = (curve.closed() ? options.turns : 1) * curve.length_m(),
                    .speed_m_per_s = std::min(options.rate_hz * round_m, max_slide_m_per_s),
                    .ramp_s = std::max(0.6, rise_s)};
  const double way_s = slide.duration_s(), moving_s = ways * way_s;
  const double duration_s = 2.0 * landing_s + moving_s;
  return sampled(std::move(name), Technique::rub, duration_s, [&](double t) {
    const double since = t - landing_s;
    const int way = std::clamp(static_cast<int>(since / way_s), 0, ways - 1);
    const double gone_m = slide.way_m(since - way * way_s);
    const body::SurfacePoint point = curve.at(way % 2 == 0 ? gone_m : curve.length_m() - gone_m);
    const double touch = smooth_window(t, duration_s, landing_s);
    const double rub = smooth_window(since, moving_s, rise_s);
    return ContactPoint{.at_in_couch = point.at_in_couch,
                        .normal_in_couch = point.normal_in_couch,
                        .force_n = kept_n * touch + rubbed_n * rub};
  });
}

}  // namespace tuina::massage
