// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/stroke.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {
namespace {

/// A cubic from b to c whose slopes look at a and d: Catmull-Rom, centripetal, so that places that
/// are near each other beside others that are not are not run past. At an end a is b, or d is c.
Vector3 between(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d, double t) {
  const double before = std::sqrt((b - a).norm()), span = std::sqrt((c - b).norm()),
               behind = std::sqrt((d - c).norm());
  const auto slope = [&](const Vector3& from, const Vector3& at, const Vector3& to, double first,
                         double second) {
    const Vector3 mean = (at - from) / first - (to - from) / (first + second) + (to - at) / second;
    return Vector3(span * mean);
  };
  const Vector3 half = 0.5 * (c - b);
  const Vector3 slope_b = before > 0.0 ? slope(a, b, c, before, span) : half;
  const Vector3 slope_c = behind > 0.0 ? slope(b, c, d, span, behind) : half;
  const double s = t * t * (3.0 - 2.0 * t);
  return (1.0 - s) * b + s * c + t * (1.0 - t) * (1.0 - t) * slope_b - t * t * (1.0 - t) * slope_c;
}

/// The first place where a line turns back, which no tool does at its speed, or why else it is
/// none.
Result<void> check_line(std::span<const Vector3> places) {
  constexpr double max_turn_rad = 100_deg;
  if (places.size() < 2) {
    return fail(Fault::bad_input, "a stroke needs two places at least, {} given", places.size());
  }
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Vector3 on = places[i] - places[i - 1];
    if (on.norm() < 1_mm) {
      return fail(Fault::not_found,
                  "places {} and {} of the stroke are {:.1f} mm apart: 1 at least", i, i + 1,
                  to_mm(on.norm()));
    }
    if (i == 1) continue;
    const Vector3 so_far = places[i - 1] - places[i - 2];
    const double turn_rad = std::atan2(so_far.cross(on).norm(), so_far.dot(on));
    if (turn_rad > max_turn_rad) {
      return fail(Fault::not_found,
                  "the stroke turns by {:.0f} degrees at place {}: {:.0f} at most, or two strokes",
                  to_deg(turn_rad), i, to_deg(max_turn_rad));
    }
  }
  return {};
}

}  // namespace

Result<SurfaceCurve> line_through(const body::BackSurface& back,
                                  std::span<const Vector3> places_in_couch, const Bend& bend) {
  constexpr double step_m = 3_mm;
  std::vector<Vector3> places;
  std::vector<Vector3> outward;
  for (const Vector3& place : places_in_couch) {
    const body::SurfacePoint on_skin = back.nearest(place);
    places.push_back(on_skin.at_in_couch);
    outward.push_back(on_skin.normal_in_couch);
  }
  if (auto usable = check_line(places); !usable) return tl::unexpected(usable.error());
  std::vector<Vector3> guide;
  std::vector<Vector3> guide_outward;
  const std::size_t last = places.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const Vector3& a = places[i == 0 ? 0 : i - 1];
    const Vector3& d = places[std::min(i + 2, last)];
    const double chord_m = (places[i + 1] - places[i]).norm();
    const int steps = std::max(4, static_cast<int>(std::ceil(chord_m / step_m)));
    for (int k = 0; k < steps + (i + 1 == last ? 1 : 0); ++k) {
      const double t = static_cast<double>(k) / steps;
      const Vector3 point = between(a, places[i], places[i + 1], d, t);
      guide.push_back(bend ? bend(point) : point);
      guide_outward.push_back(((1.0 - t) * outward[i] + t * outward[i + 1]).normalized());
    }
  }
  const auto lifted = lift(back, guide, guide_outward);
  if (!lifted) return tl::unexpected(lifted.error());
  return SurfaceCurve(*lifted, false);
}

double hand_over_hand_pass_s(double length_m, double speed_m_per_s) {
  const Slide forward{.length_m = length_m, .speed_m_per_s = speed_m_per_s};
  const Slide back{.length_m = length_m, .speed_m_per_s = max_slide_m_per_s};
  return std::max(forward.duration_s(), back.duration_s() + 2.0 * hands_overlap_s);
}

ContactPath plan_stroke(const SurfaceCurve& line, const StrokeOptions& options, std::string name) {
  const double kept_n = std::min(kept_force_n, options.force_n);
  const double stroked_n = options.force_n - kept_n;
  Slide slide{.length_m = line.length_m(),
              .speed_m_per_s = std::min(options.speed_m_per_s, max_slide_m_per_s)};
  Slide back = slide;
  if (options.turn) {
    slide.speed_m_per_s = slide.length_m / (options.turn->pass_s - slide.ramp_s);
    back.speed_m_per_s = max_slide_m_per_s;
  }
  const double rise_s = force_ramp_s(stroked_n, slide.ramp_s);
  // A very short line takes as long as its force needs to rise and fall.
  const double pass_s = std::max(slide.duration_s(), 2.0 * rise_s);
  const double turn_s = pass_s - hands_overlap_s;  // from one hand's stroke to the other's
  const double cycle_s = options.turn ? 2.0 * turn_s : pass_s + back.duration_s();
  const double wait_s = options.turn && options.turn->second ? turn_s : 0.0;
  const double duration_s = 2.0 * landing_s + wait_s + (options.repeats - 1) * cycle_s + pass_s;
  return sampled(std::move(name), Technique::stroke, duration_s, [&](double t) {
    const double since = t - landing_s - wait_s;
    const int cycle = std::clamp(static_cast<int>(since / cycle_s), 0, options.repeats - 1);
    const double in_cycle = since - cycle * cycle_s;
    const bool back_again = in_cycle > pass_s && cycle + 1 < options.repeats;
    const double way_m =
        back_again ? line.length_m() - back.way_m(in_cycle - pass_s) : slide.way_m(in_cycle);
    const body::SurfacePoint point = line.at(way_m);
    const double touch = smooth_window(t, duration_s, landing_s);
    const double stroke = smooth_window(in_cycle, pass_s, rise_s);
    return ContactPoint{.at_in_couch = point.at_in_couch,
                        .normal_in_couch = point.normal_in_couch,
                        .force_n = kept_n * touch + stroked_n * stroke};
  });
}

}  // namespace tuina::massage
