// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {

inline constexpr double min_tap_hz = 1.0;
inline constexpr double max_tap_hz = 5.0;

/// How a place is tapped.
struct TapOptions {
  double force_n = 10.0;  ///< Force at the top of each tap.
  double rate_hz = 3.0;   ///< Taps a second, 1 to 5.
  double time_s = 4.0;    ///< Time of tapping, rounded to whole taps.
};

/// The strongest tap at a rate, N.
[[nodiscard]] inline double strongest_tap_n(double rate_hz) {
  return strongest_beat_n(rate_hz, max_tap_n_per_s);
}

/// Tapping. The thesis names it and never specifies it; here it is percussion without leaving the
/// skin: raised cosines of force from the kept force to the peak. A force above `strongest_tap_n`
/// is lowered to it, so whoever orders one is told before.
[[nodiscard]] ContactPath plan_tap(const body::SurfacePoint& place, const TapOptions& options,
                                   std::string name);

}  // namespace tuina::massage
