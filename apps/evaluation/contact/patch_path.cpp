// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/contact/patch_path.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/technique/surface_curve.hpp"
#include "tuina/massage/technique/tap.hpp"
#include "tuina/massage/technique_law.hpp"

namespace tuina::app {
namespace {

constexpr double stroke_m_per_s = 0.05;
constexpr double stroke_m = 0.25;

ContactPath press_path(const body::SurfacePoint& place, const PatchTask& task) {
  massage::PressOptions options{.force_n = task.force_n, .repeats = 1, .window = task.window};
  while (options.repeats < 1000) {
    options.repeats += 1;
    if (massage::plan_press(place, options, "").duration_s() > task.duration_s) break;
  }
  options.repeats -= 1;
  return massage::plan_press(place, options, name_of(Technique::press));
}

ContactPath tap_path(const body::SurfacePoint& place, const PatchTask& task) {
  const double time_s = std::max(task.duration_s - 2.0 * massage::landing_s, 1.0);
  return massage::plan_tap(place,
                           {.force_n = task.force_n, .rate_hz = task.tap_hz, .time_s = time_s},
                           name_of(Technique::tap));
}

/// The place `across_m` along the bent skin and `along_m` up it.
body::SurfacePoint place_on(const BelievedPatch& patch, double across_m, double along_m) {
  const Vector3 along = Vector3::UnitZ(), across = along.cross(patch.normal_in_couch);
  const Vector3 upward = patch.centre_in_couch + along_m * along;
  if (!std::isfinite(patch.bend_radius_m))
    return {.at_in_couch = upward + across_m * across, .normal_in_couch = patch.normal_in_couch};
  const double angle = across_m / patch.bend_radius_m;
  const Vector3 normal = std::cos(angle) * patch.normal_in_couch + std::sin(angle) * across;
  return {.at_in_couch = upward + patch.bend_radius_m * (normal - patch.normal_in_couch),
          .normal_in_couch = normal};
}

/// A circle of the usual size, which begins at the centre of the patch.
ContactPath circle_path(const BelievedPatch& patch, const PatchTask& task) {
  constexpr double step_rad = 0.05;
  const int places = static_cast<int>(std::lround(2.0 * pi / step_rad));
  const massage::TechniqueLaw& law = massage::law_of(task.technique);
  const massage::Part part{.technique = task.technique,
                           .radius_m = from_mm(law.radius_mm.usual),
                           .rate_hz = law.rate_hz.usual};
  std::vector<body::SurfacePoint> points;
  for (int k = 0; k < places; ++k) {
    const double angle = 2.0 * pi * k / places;
    points.push_back(place_on(patch, part.radius_m - part.radius_m * std::cos(angle),
                              part.radius_m * std::sin(angle)));
  }
  const massage::SurfaceCurve circle(points, true);
  massage::SlidingOrder order{.part = part, .force_n = task.force_n};
  const double circling_s = task.duration_s - 2.0 * massage::landing_s;
  order.repeats =
      std::max(1, static_cast<int>(std::lround(circling_s / law.once_s(circle, order))));
  return law.along(circle, order, name_of(task.technique));
}

struct Rub {
  massage::SurfaceCurve curve;
  double speed_m_per_s;
};

/// Each shape begins at the centre of the patch and comes back to it.
Rub rub_on(const BelievedPatch& patch, RubShape shape) {
  constexpr double radius_m = 30_mm;
  constexpr double long_m = 45_mm, short_m = 20_mm;             // half axes of the ellipse
  constexpr double innermost_m = 6_mm, turns_out_and_in = 6.0;  // of the spiral
  const bool spiral = shape == RubShape::spiral;
  const double end = 2.0 * pi * (spiral ? turns_out_and_in : 1.0);
  const double step_rad = spiral ? 0.1 : 0.05;
  const int places = static_cast<int>(std::lround(end / step_rad));
  std::vector<body::SurfacePoint> points;
  for (int k = 0; k < places; ++k) {
    const double angle = end * k / places;
    const double radius =
        innermost_m + (radius_m - innermost_m) * 0.5 * (1.0 - std::cos(angle / turns_out_and_in));
    const double along_m = spiral ? radius : shape == RubShape::ellipse ? long_m : radius_m;
    const double across_m = shape == RubShape::ellipse ? short_m : along_m;
    const double centre_m = spiral ? innermost_m : across_m;
    points.push_back(
        place_on(patch, centre_m - across_m * std::cos(angle), along_m * std::sin(angle)));
  }
  const double rate_hz = shape == RubShape::circle ? 0.5 : 0.35;
  return {massage::SurfaceCurve(points, true), 2.0 * pi * radius_m * rate_hz};
}

}  // namespace

ContactPath path_on(const BelievedPatch& patch, const PatchTask& task) {
  if (task.technique == Technique::press) return press_path(place_on(patch, 0.0, 0.0), task);
  if (task.technique == Technique::tap) return tap_path(place_on(patch, 0.0, 0.0), task);
  const bool rub = task.technique == Technique::rub;
  if (!rub && task.technique != Technique::stroke) return circle_path(patch, task);

  const double ramp_s = massage::force_ramp_s(task.force_n, 0.9);
  const Rub rubbed = rub_on(patch, task.rub_shape);
  // Standing and pressing first, then moving, then standing again until the force is gone.
  massage::Slide slide{.length_m = stroke_m, .speed_m_per_s = stroke_m_per_s};
  if (rub) {
    constexpr double min_duration_s = 4.0;
    slide.speed_m_per_s = rubbed.speed_m_per_s;
    slide.length_m = slide.speed_m_per_s *
                     (std::max(task.duration_s - 2.0 * ramp_s, min_duration_s) - slide.ramp_s);
  }
  const double duration_s = slide.duration_s() + 2.0 * ramp_s;
  return massage::sampled(name_of(task.technique), task.technique, duration_s, [&](double t) {
    const double way_m = slide.way_m(std::clamp(t - ramp_s, 0.0, slide.duration_s()));
    const double stroked_m = 0.5 * stroke_m - way_m;
    const body::SurfacePoint place = rub ? rubbed.curve.at(way_m)
                                         : place_on(patch, task.stroke_across ? stroked_m : 0.0,
                                                    task.stroke_across ? 0.0 : stroked_m);
    const double share = massage::smooth_window(t, duration_s, ramp_s);
    return ContactPoint{.at_in_couch = place.at_in_couch,
                        .normal_in_couch = place.normal_in_couch,
                        .force_n = task.force_n * share};
  });
}

}  // namespace tuina::app
