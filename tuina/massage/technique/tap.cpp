// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/tap.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {

ContactPath plan_tap(const body::SurfacePoint& place, const TapOptions& options, std::string name) {
  const double rate_hz = std::clamp(options.rate_hz, min_tap_hz, max_tap_hz);
  const double force_n = std::min(options.force_n, strongest_tap_n(rate_hz));
  const double kept_n = std::min(kept_force_n, force_n);
  const double taps = std::max(1.0, std::round(options.time_s * rate_hz));
  const double tapping_s = taps / rate_hz;
  const double duration_s = 2.0 * landing_s + tapping_s;
  return sampled(std::move(name), Technique::tap, duration_s, [&](double t) {
    const double since = std::clamp(t - landing_s, 0.0, tapping_s);
    const double touch = smooth_window(t, duration_s, landing_s);
    const double wave = 0.5 * (1.0 - std::cos(2.0 * pi * rate_hz * since));
    return ContactPoint{.at_in_couch = place.at_in_couch,
                        .normal_in_couch = place.normal_in_couch,
                        .force_n = kept_n * touch + (force_n - kept_n) * wave};
  });
}

}  // namespace tuina::massage
