// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tuina/core/contact.hpp"

namespace tuina::massage {

/// Sampling of paths, and the laws that carry force and movement from one value to the next without
/// a step, for all techniques. Bounds are those of contact at 1 kHz on a person: the
/// rate of force and the tangential speed are kept by construction, not checked afterwards.
inline constexpr double sample_s = 0.01;
inline constexpr double max_force_n_per_s = 100.0;
inline constexpr double max_slide_m_per_s = 0.080;
/// Between presses, and while the tool is moved along the skin unloaded, it stays on the skin with
/// this force: leaving and touching again would be an impact every time.
inline constexpr double kept_force_n = 3.0;
/// Fastest change of a force that beats while the tool slides. It is slower than other changes:
/// within a beat no feedback corrects a tissue that is softer than believed, so the error grows
/// with this rate.
inline constexpr double max_beat_n_per_s = 70.0;
/// Fastest change of the force of a tap, which stays in one place, so that each is corrected by the
/// one before: 30 N three times a second.
inline constexpr double max_tap_n_per_s = 260.0;
/// Time from the first touch to the kept force, and back at the end.
inline constexpr double landing_s = 0.5;

/// 0 before 0, 1 after `length_s`, in between the minimum-jerk polynomial 10u^3 - 15u^4 + 6u^5.
[[nodiscard]] double smooth_step(double time_s, double length_s);
/// Its integral over time.
[[nodiscard]] double smooth_step_integral(double time_s, double length_s);
/// Largest slope of a smooth step, times its length.
inline constexpr double smooth_step_steepest = 1.875;

/// Up in `ramp_s` from 0, down in `ramp_s` to `length_s`, both as smooth steps; 1 in between.
[[nodiscard]] double smooth_window(double time_s, double length_s, double ramp_s);

/// The shortest time in which a smooth step changes the force by `change_n`, at least `wanted_s`.
[[nodiscard]] double force_ramp_s(double change_n, double wanted_s);

/// The largest force that beats at a rate and changes by at most `max_n_per_s`: a raised cosine
/// between the kept force and the peak is steepest with pi x rate x (peak - kept).
[[nodiscard]] double strongest_beat_n(double rate_hz, double max_n_per_s);

/// A way of `length_m` along a curve from rest to rest: smooth gain of speed, constant speed,
/// smooth loss of speed. The speed is lowered where the way is too short to reach it.
struct Slide {
  double length_m = 0.0;
  double speed_m_per_s = 0.05;
  double ramp_s = 0.5;

  [[nodiscard]] double duration_s() const;
  /// Way that lies behind after a time; all of it after `duration_s`.
  [[nodiscard]] double way_m(double time_s) const;
  [[nodiscard]] double top_speed_m_per_s() const;
};

/// The path sampled every 10 ms from 0 to the first sample at or after `duration_s`; force is zero
/// at both ends.
[[nodiscard]] ContactPath sampled(std::string name, Technique technique, double duration_s,
                                  const std::function<ContactPoint(double time_s)>& at);

}  // namespace tuina::massage
