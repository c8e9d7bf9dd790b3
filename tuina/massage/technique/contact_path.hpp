// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tuina/core/contact.hpp"

namespace tuina::massage {

/// What all techniques share: how a path is sampled, and the laws that carry force and movement
/// from one value to the next without a step. Bounds are those of contact at 1 kHz on a person: the
/// rate of force and the tangential speed are kept by construction, not checked afterwards.
inline constexpr double sample_s = 0.01;
inline constexpr double max_force_n_per_s = 100.0;
inline constexpr double max_slide_m_per_s = 0.080;
/// Between presses, and while the tool is moved along the skin unloaded, it stays on the skin with
/// this force: leaving and touching again would be an impact every time.
inline constexpr double kept_force_n = 3.0;
/// Time from the first touch to the kept force, and back at the end.
inline constexpr double landing_s = 0.5;

/// 0 before 0, 1 after `length_s`, in between the minimum-jerk polynomial 10u^3 - 15u^4 + 6u^5.
[[nodiscard]] double smooth_step(double time_s, double length_s);
/// Its integral over time.
[[nodiscard]] double smooth_step_integral(double time_s, double length_s);
inline constexpr double smooth_step_steepest = 1.875;  ///< largest slope times length

/// The shortest time in which a smooth step changes the force by `change_n`, at least `wanted_s`.
[[nodiscard]] double force_ramp_s(double change_n, double wanted_s);

/// A way of `length_m` along a curve from rest to rest: smooth gain of speed, constant speed,
/// smooth loss of speed. The speed is lowered where the way is too short to reach it.
struct Slide {
  double length_m = 0.0;
  double speed_m_per_s = 0.05;
  double ramp_s = 0.5;

  [[nodiscard]] double duration_s() const;
  [[nodiscard]] double way_m(double time_s) const;
  [[nodiscard]] double top_speed_m_per_s() const;
};

/// The path sampled every 10 ms from 0 to the first sample at or after `duration_s`; force is zero
/// at both ends.
[[nodiscard]] ContactPath sampled(std::string name, Technique technique, double duration_s,
                                  const std::function<ContactPoint(double time_s)>& at);

}  // namespace tuina::massage
