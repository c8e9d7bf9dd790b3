// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "tuina/session/config.hpp"

namespace tuina::session {

/// One way in which a simulated world is as unkind as the real one.
struct SimulatedEffect {
  std::string_view key;  ///< in the config
  double Config::Simulation::*value;
  double ideal, usual, hard;
  double min, max;
  std::string_view source;  ///< of the sizes: a key of docs/references.md, or how they are known
};
/// All of them, in the units of their keys.
[[nodiscard]] std::span<const SimulatedEffect> simulated_effects();

/// Sets every effect as `simulation.realism` says.
void set_realism(Config::Simulation& simulation);

}  // namespace tuina::session
