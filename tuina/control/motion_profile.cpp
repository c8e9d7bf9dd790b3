// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/motion_profile.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::control {
namespace {

using Stretch = MotionProfile::Stretch;
using Stretches = std::array<Stretch, 3>;

MotionState after(const MotionState& state, const Stretch& stretch, double time_s) {
  const double t = time_s, j = stretch.jerk_per_s3;
  return {.at = state.at +
                t * (state.speed_per_s + t * (state.acceleration_per_s2 / 2.0 + t * j / 6.0)),
          .speed_per_s = state.speed_per_s + t * (state.acceleration_per_s2 + t * j / 2.0),
          .acceleration_per_s2 = state.acceleration_per_s2 + t * j};
}

MotionState after(MotionState state, const Stretches& stretches) {
  for (const Stretch& stretch : stretches) state = after(state, stretch, stretch.duration_s);
  return state;
}

// Time-optimal change from (speed, acceleration) to (goal speed, 0): jerk, hold, jerk back.
Stretches change_speed(const MotionState& start, double goal_speed, const MotionLimits& limits) {
  const double J = limits.jerk_per_s3, A = limits.acceleration_per_s2;
  // The speed left after removing the acceleration at once decides the direction of the jerk.
  const double a = start.acceleration_per_s2;
  const double coast = start.speed_per_s + a * std::abs(a) / (2.0 * J);
  const double direction = goal_speed >= coast ? 1.0 : -1.0;
  const double a0 = direction * a;
  const double gain = direction * (goal_speed - start.speed_per_s);
  if (a0 > A) {
    const double hold_s = (gain - a0 * a0 / (2.0 * J)) / A;
    return {
        {{(a0 - A) / J, -direction * J}, {std::max(hold_s, 0.0), 0.0}, {A / J, -direction * J}}};
  }
  const double peak = std::min(std::sqrt(std::max(J * gain + a0 * a0 / 2.0, 0.0)), A);
  const double hold_s = (gain - (2.0 * peak * peak - a0 * a0) / (2.0 * J)) / A;
  return {{{std::max(peak - a0, 0.0) / J, direction * J},
           {peak < A ? 0.0 : std::max(hold_s, 0.0), 0.0},
           {peak / J, -direction * J}}};
}

double stop_at(const MotionState& state, const MotionLimits& limits) {
  return after(state, change_speed(state, 0.0, limits)).at;
}

bool usable(const MotionState& start, double goal, const MotionLimits& limits) {
  return std::isfinite(start.at) && std::isfinite(start.speed_per_s) &&
         std::isfinite(start.acceleration_per_s2) && std::isfinite(goal) &&
         limits.speed_per_s > 0.0 && limits.acceleration_per_s2 > 0.0 && limits.jerk_per_s3 > 0.0 &&
         std::isfinite(limits.speed_per_s + limits.acceleration_per_s2 + limits.jerk_per_s3);
}

// Zero of an increasing function in a bracket, by regula falsi with the Illinois rule; after the
// maximum of iterations the best point is returned.
template <typename Function>
double find_zero(const Function& f, double low, double f_low, double high, double f_high,
                 double tolerance) {
  double x = high;
  for (int i = 0; i < 60 && high > low; ++i) {
    x = f_high > f_low ? high - f_high * (high - low) / (f_high - f_low) : 0.5 * (low + high);
    if (!(x > low && x < high) || i % 8 == 7) x = 0.5 * (low + high);
    const double value = f(x);
    if (std::abs(value) <= tolerance || x == low || x == high) break;
    if (value > 0.0) {
      if (high == x) break;
      high = x;
      f_high = value;
      f_low *= 0.5;
    } else {
      low = x;
      f_low = value;
      f_high *= 0.5;
    }
  }
  return x;
}

}  // namespace

// The optimum accelerates towards the goal while an immediate stop would end short of it, then
// stops. The stopping point grows with the acceleration time, so that time is the zero of an
// increasing function.
bool MotionProfile::plan(const MotionState& start, double goal,
                         const MotionLimits& limits) noexcept {
  if (!usable(start, goal, limits)) return false;
  const double ahead = goal - stop_at(start, limits);
  const double side = ahead >= 0.0 ? 1.0 : -1.0;
  const double scale = std::abs(goal - start.at) + limits.speed_per_s * 1e-3;
  // A goal reached by stopping is exact to rounding only, and rounding must not cause a detour.
  const bool stops = std::abs(ahead) <= 1e-12 * scale;
  const Stretches push =
      stops ? Stretches{} : change_speed(start, side * limits.speed_per_s, limits);

  std::array<Stretch, 7> stretches = {};
  MotionState state = start;
  bool cruises = !stops;
  for (std::size_t i = 0; i < push.size() && cruises; ++i) {
    const auto short_by = [&](double time_s) {
      return side * (stop_at(after(state, push[i], time_s), limits) - goal);
    };
    double time_s = push[i].duration_s;
    const double miss = short_by(time_s);
    if (miss > 0.0) {
      time_s = find_zero(short_by, 0.0, short_by(0.0), time_s, miss, 1e-13 * scale);
      cruises = false;
    }
    stretches[i] = {time_s, push[i].jerk_per_s3};
    state = after(state, push[i], time_s);
  }
  if (cruises) {
    stretches[3].duration_s =
        std::max(side * (goal - stop_at(state, limits)) / limits.speed_per_s, 0.0);
    state = after(state, stretches[3], stretches[3].duration_s);
  }
  const Stretches stop = change_speed(state, 0.0, limits);
  std::copy(stop.begin(), stop.end(), stretches.begin() + 4);

  start_ = start;
  goal_ = goal;
  stretches_ = stretches;
  duration_s_ = 0.0;
  for (const Stretch& stretch : stretches_) duration_s_ += stretch.duration_s;
  return true;
}

bool MotionProfile::plan_stop(const MotionState& start, const MotionLimits& limits) noexcept {
  if (!usable(start, 0.0, limits)) return false;
  const Stretches stop = change_speed(start, 0.0, limits);
  start_ = start;
  goal_ = after(start, stop).at;
  stretches_ = {stop[0], stop[1], stop[2]};
  duration_s_ = stop[0].duration_s + stop[1].duration_s + stop[2].duration_s;
  return true;
}

// A lower speed limit stretches the motion without bound, so some limit gives the wanted duration.
bool MotionProfile::plan_in(double duration_s, const MotionState& start, double goal,
                            const MotionLimits& limits) noexcept {
  if (!plan(start, goal, limits)) return false;
  const double lacking_s = duration_s - duration_s_;
  if (!(lacking_s > 1e-9)) return true;
  // The duration is nearly linear in the slowness 1 / speed.
  const double fastest = 1.0 / limits.speed_per_s;
  const auto too_long = [&](double slowness) {
    (void)plan(start, goal, {1.0 / slowness, limits.acceleration_per_s2, limits.jerk_per_s3});
    return duration_s_ - duration_s;
  };
  double high = fastest, miss = -lacking_s;
  for (int i = 0; i < 30 && miss < 0.0; ++i) miss = too_long(high *= 2.0);
  if (miss < 0.0) return plan(start, goal, limits);  // already at the goal
  const double slowness = find_zero(too_long, fastest, -lacking_s, high, miss, 1e-9);
  (void)too_long(slowness);
  return true;
}

MotionState MotionProfile::at(double time_s) const noexcept {
  if (time_s >= duration_s_) return {.at = goal_};
  MotionState state = start_;
  double left_s = std::max(time_s, 0.0);
  for (const Stretch& stretch : stretches_) {
    if (left_s <= stretch.duration_s) return after(state, stretch, left_s);
    state = after(state, stretch, stretch.duration_s);
    left_s -= stretch.duration_s;
  }
  return {.at = goal_};
}

}  // namespace tuina::control
