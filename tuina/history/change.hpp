// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tuina/history/history.hpp"

namespace tuina::history {

/// Standard deviation of the logarithm by which a press of the same place differs from session to
/// session though nothing has changed: the tool stands some millimetres beside. Assumed as long as
/// a person has too few sessions to tell it.
inline constexpr double assumed_scatter = 0.05;

/// A place between a session and the one before it in which it was pressed.
struct PlaceChange {
  std::string name;
  double before_n_per_mm = 0.0, after_n_per_mm = 0.0;
  double change = 0.0;           ///< relative
  double low = 0.0, high = 0.0;  ///< relative; hold the change in 95 % of cases, taken by itself
  double p = 1.0;     ///< probability of seeing as much or more though nothing has changed
  bool real = false;  ///< by the test over all places
};

/// Changes of stiffness from one session to a later one, by place.
struct Changes {
  std::vector<PlaceChange> places;
  double scatter = assumed_scatter;  ///< standard deviation of the logarithm, between sessions
  bool scatter_assumed = true;
};

/// The scatter between the sessions of a person as their places tell it, in order of time, but at
/// least the assumed one.
[[nodiscard]] double log_scatter(std::span<const Visit> visits);

/// Two-sided test of each place's logarithm of stiffness, with the intervals of both sessions and
/// the scatter between sessions (Student's t where that is an estimate); over all places by Holm's
/// rule, [holm1979], so that in 95 of 100 sessions without any change none is called real. Scatter
/// is estimated from the sessions of `earlier` (in order of time) when places were felt often
/// enough; of a place pressed several times in a session the last press counts.
[[nodiscard]] Changes changes_between(const Visit& before, const Visit& after,
                                      std::span<const Visit> earlier = {});

}  // namespace tuina::history
