// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tuina::app {

/// A person on a rigid torso comes towards the tool at 0.1 m/s, and the arm, which so far kept its
/// force, pushes itself away after a time, at once and with all of its reflex: a tool of one mass
/// in one dimension, nothing else in its way. No law that hears of the person so late does better.
struct ReflexBound {
  std::string tissue;
  double force_n = 0.0;    ///< held when the person begins to move
  double after_ms = 0.0;   ///< when the arm answers
  double push_n = 0.0;     ///< with how much
  double highest_n = 0.0;  ///< of the contact
};
[[nodiscard]] std::vector<ReflexBound> reflex_bounds();

}  // namespace tuina::app
