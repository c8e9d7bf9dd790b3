// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tuina::app {

/// What the test of real changes says of one person's sessions in which tissue has changed, and has
/// not. Felt by the estimator of every session, in presses that do not keep to its law.
struct PowerOutcome {
  int places = 0;                 ///< each alone harder by 10 % in alpha, once
  int found = 0;                  ///< of these
  int found_of_all = 0;           ///< of all places, harder together
  bool false_alarm = false;       ///< any place called real where nothing has changed
  double stiffness_change = 0.0;  ///< true change of the stiffness that is compared, mean
  double scatter = 0.0;           ///< between sessions, as the test estimates it
};

/// How tissue differs from session to session though nothing has changed: alpha by this standard
/// deviation of its logarithm, beta by two fifths of it, as the places of the simulated back do.
[[nodiscard]] PowerOutcome try_power(double scatter, std::uint64_t seed);

}  // namespace tuina::app
