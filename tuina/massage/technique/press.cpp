// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/press.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {
namespace {

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

}  // namespace

double PressWindow::at(double time_s) const {
  if (time_s <= 0.0 || time_s >= length_s()) return 0.0;
  // (3.20) is symmetric in time about the middle of the window.
  const double t = std::min(time_s, length_s() - time_s);
  if (t >= edge_s) return 1.0;
  const double a = steepness / edge_s;
  const double jump = sigmoid(-0.5 * steepness);
  // Rounding may carry the end of the edge a little beyond one.
  return std::min((sigmoid(a * (t - 0.5 * edge_s)) - jump) / (1.0 - 2.0 * jump), 1.0);
}

double PressWindow::max_slope_per_s() const {
  return 0.25 * steepness / edge_s / (1.0 - 2.0 * sigmoid(-0.5 * steepness));
}

ContactPath plan_press(const body::SurfacePoint& place, const PressOptions& options,
                       std::string name) {
  const double kept_n = std::min(kept_force_n, options.force_n);
  const double pressed_n = options.force_n - kept_n;
  PressWindow window = options.window;
  const double too_fast = pressed_n * window.max_slope_per_s() / max_force_n_per_s;
  window.edge_s *= std::max(1.0, too_fast);

  const double cycle_s = window.length_s() + options.pause_s;
  const double pressing_s = options.repeats * cycle_s - options.pause_s;
  const double duration_s = 2.0 * landing_s + pressing_s;
  return sampled(std::move(name), Technique::press, duration_s, [&](double t) {
    const double since = t - landing_s;
    const int cycle = std::clamp(static_cast<int>(since / cycle_s), 0, options.repeats - 1);
    const double touch = smooth_window(t, duration_s, landing_s);
    return ContactPoint{.at_in_couch = place.at_in_couch,
                        .normal_in_couch = place.normal_in_couch,
                        .force_n = kept_n * touch + pressed_n * window.at(since - cycle * cycle_s)};
  });
}

}  // namespace tuina::massage
