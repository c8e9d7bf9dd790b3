// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/contact_path.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::massage {

double smooth_step(double time_s, double length_s) {
  if (time_s <= 0.0) return 0.0;
  if (time_s >= length_s) return 1.0;
  const double u = time_s / length_s;
  return u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
}

double smooth_step_integral(double time_s, double length_s) {
  if (time_s <= 0.0) return 0.0;
  if (time_s >= length_s) return 0.5 * length_s + (time_s - length_s);
  const double u = time_s / length_s;
  return length_s * u * u * u * u * (2.5 + u * (-3.0 + u));
}

double smooth_window(double time_s, double length_s, double ramp_s) {
  return smooth_step(time_s, ramp_s) - smooth_step(time_s - (length_s - ramp_s), ramp_s);
}

double force_ramp_s(double change_n, double wanted_s) {
  // A twentieth is kept back, so that two laws that overlap for a moment stay below the bound too.
  const double min_duration_s =
      smooth_step_steepest * std::abs(change_n) / (0.95 * max_force_n_per_s);
  return std::max(wanted_s, min_duration_s);
}

double strongest_beat_n(double rate_hz, double max_n_per_s) {
  return kept_force_n + max_n_per_s / (pi * rate_hz);
}

double Slide::top_speed_m_per_s() const {
  // Gaining and losing speed take half of speed x ramp each.
  return std::min(speed_m_per_s, length_m / ramp_s);
}

double Slide::duration_s() const {
  const double speed = top_speed_m_per_s();
  return speed > 0.0 ? length_m / speed + ramp_s : 0.0;
}

double Slide::way_m(double time_s) const {
  const double gained = smooth_step_integral(time_s, ramp_s);
  const double lost = smooth_step_integral(time_s - (duration_s() - ramp_s), ramp_s);
  return std::clamp(top_speed_m_per_s() * (gained - lost), 0.0, length_m);
}

ContactPath sampled(std::string name, Technique technique, double duration_s,
                    const std::function<ContactPoint(double time_s)>& at) {
  ContactPath path;
  path.name = std::move(name);
  path.technique = technique;
  const int steps = std::max(1, static_cast<int>(std::ceil(duration_s / sample_s - 1e-9)));
  path.points.reserve(static_cast<std::size_t>(steps) + 1);
  for (int i = 0; i <= steps; ++i) {
    ContactPoint point = at(i * sample_s);
    point.time_s = i * sample_s;
    path.points.push_back(point);
  }
  path.points.front().force_n = 0.0;
  path.points.back().force_n = 0.0;
  return path;
}

}  // namespace tuina::massage
