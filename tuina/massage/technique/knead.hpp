// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/core/contact.hpp"
#include "tuina/massage/technique/surface_curve.hpp"

namespace tuina::massage {

/// Circles of kneading are taught 2 to 3 cm across; the tool, wider than a thumb, may have 4.
inline constexpr double min_knead_radius_m = 0.010;
inline constexpr double max_knead_radius_m = 0.020;
/// Turns a second. Experts knead with 2.2 and learners with 1.1, [wu2023]; at 1.25 the smallest
/// circle is as fast as the tool may slide.
inline constexpr double min_knead_hz = 0.5;
inline constexpr double max_knead_hz = 1.25;

/// How a place is kneaded.
struct KneadOptions {
  double force_n = 18.0;  ///< Force at the height of each turn.
  double rate_hz = 0.8;   ///< Turns a second, if neither speed nor force changes too fast.
  int turns = 6;
};

/// Turns a second that are really given on a circle: the tool slides no faster than it may, and the
/// force changes no faster than a beating force may. A firm knead is a slow one.
[[nodiscard]] double knead_hz(const SurfaceCurve& circle, const KneadOptions& options);

/// Kneading, rou fa of tuina: pressing in small circles in one place, a force that swells and ebbs
/// with each turn. It is a raised cosine of the angle, from the kept force where the circle begins
/// to the whole force opposite of it, so force and place stay locked also while the tool gains and
/// loses speed. Whole turns, from rest to rest.
[[nodiscard]] ContactPath plan_knead(const SurfaceCurve& circle, const KneadOptions& options,
                                     std::string name);

}  // namespace tuina::massage
