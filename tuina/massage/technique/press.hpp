// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/contact.hpp"

namespace tuina::massage {

/// The time window of one press, [thesis] (3.20): a sigmoid edge of `edge_s` (eta), `hold_s` (T) at
/// full force, a sigmoid edge down. The thesis' sigmoid jumps by 1/(1+exp(a eta/2)) at its ends and
/// prints the third branch over the second one's time; here it runs from eta+T to 2 eta+T, and the
/// edges are scaled to reach 0 and 1 exactly.
struct PressWindow {
  double edge_s = 0.9;
  double hold_s = 2.0;
  double steepness = 10.0;  ///< Product a x eta, without a unit.

  [[nodiscard]] double length_s() const { return 2.0 * edge_s + hold_s; }
  [[nodiscard]] double at(double time_s) const;  ///< 0 to 1; 0 outside of the window.
  [[nodiscard]] double max_slope_per_s() const;  ///< Slope in the middle of an edge.
};

/// How a place is pressed.
struct PressOptions {
  double force_n = 25.0;
  int repeats = 2;
  PressWindow window = {};
  double pause_s = 0.2;  ///< Time at the kept force between two presses.
};

/// Pressing, [thesis] 3.5.1: the force rises and falls on one place, with a light contact kept
/// between the presses. The edges are longer than asked where the force would change too fast.
[[nodiscard]] ContactPath plan_press(const body::SurfacePoint& place, const PressOptions& options,
                                     std::string name);

}  // namespace tuina::massage
