// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace tuina::app {

/// How the sessions of a person are felt, and how places differ between them though nothing has
/// changed.
struct PowerWorld {
  const char* name;
  const char* tissue;  ///< one of `sim::tissue_worlds`
  /// Standard deviation of ln alpha from session to session; of ln beta two fifths of it, as the
  /// places of the simulated back do.
  double scatter;
};
inline constexpr std::array<PowerWorld, 4> power_worlds = {
    {{"ideal, the same place", "control", 0.0},
     {"ideal, some mm beside", "control", 0.05},
     {"usual, the same place", "everything", 0.0},
     {"usual, some mm beside", "everything", 0.05}}};

/// What the test of real changes says of one person's sessions, in which tissue has changed or has
/// not. Felt by the estimator of every session, five presses a place.
struct PowerOutcome {
  int places = 0;             ///< each alone harder by 10 % in alpha, once
  int found = 0;              ///< of these
  int found_of_all = 0;       ///< of all places, harder together
  bool found_whole = false;   ///< that they are harder together
  bool false_alarm = false;   ///< any place, or all, called real where nothing has changed
  double whole_change = 0.0;  ///< of all together, as the test says, where they are harder
  double scatter = 0.0;       ///< between sessions, as the test estimates it
};
[[nodiscard]] PowerOutcome try_power(const PowerWorld& world, std::uint64_t seed);

}  // namespace tuina::app
