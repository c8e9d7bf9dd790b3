// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/patch_path.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/massage/contact_path.hpp"
#include "tuina/massage/tap.hpp"

namespace tuina::app {
namespace {

constexpr double rub_radius_m = 30_mm;
constexpr double rub_hz = 0.5;
constexpr double stroke_m_per_s = 0.05;
constexpr double stroke_m = 0.25;

ContactPath press_path(const body::SurfacePoint& place, const PatchTask& task) {
  massage::PressOptions options{.force_n = task.force_n, .repeats = 1, .window = task.window};
  while (options.repeats < 1000) {
    options.repeats += 1;
    if (massage::plan_press(place, options, "").duration_s() > task.duration_s) break;
  }
  options.repeats -= 1;
  return massage::plan_press(place, options, "press");
}

ContactPath tap_path(const body::SurfacePoint& place, const PatchTask& task) {
  const double time_s = std::max(task.duration_s - 2.0 * massage::landing_s, 1.0);
  return massage::plan_tap(
      place, {.force_n = task.force_n, .rate_hz = task.tap_hz, .time_s = time_s}, "tap");
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

}  // namespace

ContactPath path_on(const BelievedPatch& patch, const PatchTask& task) {
  if (task.technique == Technique::press) return press_path(place_on(patch, 0.0, 0.0), task);
  if (task.technique == Technique::tap) return tap_path(place_on(patch, 0.0, 0.0), task);

  const bool rub = task.technique == Technique::rub;
  const double ramp_s = massage::force_ramp_s(task.force_n, 0.9);
  // Standing and pressing first, then moving, then standing again until the force is gone.
  massage::Slide slide{.length_m = stroke_m, .speed_m_per_s = stroke_m_per_s};
  const double moving_s =
      rub ? std::max(task.duration_s - 2.0 * ramp_s, 2.0 / rub_hz) : slide.duration_s();
  if (rub) {
    slide.speed_m_per_s = 2.0 * pi * rub_radius_m * rub_hz;
    slide.length_m = slide.speed_m_per_s * (moving_s - slide.ramp_s);
  }
  const double duration_s = moving_s + 2.0 * ramp_s;
  return massage::sampled(name_of(task.technique), task.technique, duration_s, [&](double t) {
    const double way_m = slide.way_m(std::clamp(t - ramp_s, 0.0, slide.duration_s()));
    const double angle = way_m / rub_radius_m, stroked_m = 0.5 * stroke_m - way_m;
    const body::SurfacePoint place = rub ? place_on(patch, rub_radius_m * (1.0 - std::cos(angle)),
                                                    rub_radius_m * std::sin(angle))
                                         : place_on(patch, task.stroke_across ? stroked_m : 0.0,
                                                    task.stroke_across ? 0.0 : stroked_m);
    const double share =
        massage::smooth_step(t, ramp_s) - massage::smooth_step(t - (duration_s - ramp_s), ramp_s);
    return ContactPoint{.at_in_couch = place.at_in_couch,
                        .normal_in_couch = place.normal_in_couch,
                        .force_n = task.force_n * share};
  });
}

}  // namespace tuina::app
