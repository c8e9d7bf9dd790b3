// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tuina/history/history.hpp"

namespace tuina::history {

/// Standard deviation of the logarithm by which a place differs from session to session though
/// nothing has changed: the tool stands some millimetres beside. Assumed as long as a person has
/// too few sessions to tell it, and the places do not show more by how they differ.
inline constexpr double assumed_scatter = 0.05;
/// The same of what all places of a session share: the gain of the force sensor, the warmth of the
/// room. Assumed.
inline constexpr double assumed_shared_scatter = 0.01;

/// Hardness (alpha) of a place, or of all, in a session and in the one before it.
struct Change {
  std::string name;  ///< of the place; empty: all of them together
  double before_n = 0.0, after_n = 0.0;
  double change = 0.0;           ///< relative
  double low = 0.0, high = 0.0;  ///< relative; hold the change in 95 % of cases, taken by itself
  double p = 1.0;     ///< probability of seeing as much or more though nothing has changed
  bool real = false;  ///< by the test over all places
};

/// Changes from one session to a later one.
struct Changes {
  std::vector<Change> places;
  std::optional<Change> whole;       ///< what all places share, where there are enough of them
  double scatter = assumed_scatter;  ///< standard deviation of ln alpha, between sessions
  bool scatter_assumed = true;
};

/// The scatter of stiffness between the sessions of a person as their places tell it, in order of
/// time, but at least the assumed one.
[[nodiscard]] double log_scatter(std::span<const Visit> visits);

/// Two-sided tests of ln alpha, in which nothing is called real in 95 of 100 sessions without any
/// change.
///
/// Each place: with the intervals of both sessions and the scatter between sessions (Student's t
/// where that is an estimate), by Holm's rule over all places [holm1979]. All places together: what
/// they share, as in a meta-analysis with random effects, whose error is told by how the places
/// differ [hartung2001]. Each of the two may err in 2.5 of 100 sessions; where all places together
/// have changed, their share goes to the single ones [bretz2009]. Scatter is estimated from the
/// sessions of `earlier` in the position of `after` (in order of time) when places were felt often
/// enough; of a place pressed several times in a session the last press counts.
[[nodiscard]] Changes changes_between(const Visit& before, const Visit& after,
                                      std::span<const Visit> earlier = {});

}  // namespace tuina::history
