// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/knead.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {

double knead_hz(const SurfaceCurve& circle, const KneadOptions& options) {
  const double swell_n = std::max(options.force_n - kept_force_n, 1e-9);
  return std::min(
      {options.rate_hz, max_slide_m_per_s / circle.length_m(), max_beat_n_per_s / (pi * swell_n)});
}

ContactPath plan_knead(const SurfaceCurve& circle, const KneadOptions& options, std::string name) {
  const double kept_n = std::min(kept_force_n, options.force_n);
  const double swell_n = options.force_n - kept_n;
  const double round_m = circle.length_m();
  const Slide slide{.length_m = options.turns * round_m,
                    .speed_m_per_s = knead_hz(circle, options) * round_m};
  const double duration_s = 2.0 * landing_s + slide.duration_s();
  return sampled(std::move(name), Technique::knead, duration_s, [&](double t) {
    const double way_m = slide.way_m(t - landing_s);
    const body::SurfacePoint point = circle.at(way_m);
    const double height = 0.5 * (1.0 - std::cos(2.0 * pi * way_m / round_m));
    return ContactPoint{
        .at_in_couch = point.at_in_couch,
        .normal_in_couch = point.normal_in_couch,
        .force_n = kept_n * smooth_window(t, duration_s, landing_s) + swell_n * height};
  });
}

}  // namespace tuina::massage
