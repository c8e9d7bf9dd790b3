// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tuina::safety {

/// What the guard may do, mildest first; the strongest that any check asks for is done.
enum class Action : std::uint8_t {
  pass,     ///< the proposal goes through
  warn,     ///< it goes through, clamped or repaired
  freeze,   ///< the tool stays where it is
  comply,   ///< no stiffness, only damping: the tool can be pushed away
  retract,  ///< outward along the normal, then hold
  brake,    ///< the drives' brakes hold the joints: no law of torques can be trusted
};
inline constexpr std::size_t actions = 6;
/// In words for people, as reports and records have it.
[[nodiscard]] const char* name_of(Action action) noexcept;

/// What a guard does with its arm from one millisecond to the next.
enum class GuardState : std::uint8_t {
  working,    ///< proposals go through
  frozen,     ///< for as long as its cause lasts
  held,       ///< frozen for good: from here on a state is a stop and lasts
  complying,  ///< likewise, and so the others
  retracting,
  braked,
};
inline constexpr std::size_t guard_states = 6;

/// True for a stop: it lasts as long as this guard. Who goes on begins with a new one.
[[nodiscard]] constexpr bool is_stop(GuardState state) {
  return state >= GuardState::held;
}

/// The guard's only table of states: a row for each state, a column for each action. A stop never
/// ends and never grows milder, and what complies, leaves or brakes is always a stop. A freeze is
/// one where it `lasts`.
[[nodiscard]] constexpr GuardState next_state(GuardState state, Action asked, bool lasts) {
  using enum GuardState;
  constexpr std::array<std::array<GuardState, actions>, guard_states> table = {{
      // pass      warn        freeze      comply      retract     brake
      {working, working, frozen, complying, retracting, braked},             // working
      {working, working, frozen, complying, retracting, braked},             // frozen
      {held, held, held, complying, retracting, braked},                     // held
      {complying, complying, complying, complying, retracting, braked},      // complying
      {retracting, retracting, retracting, retracting, retracting, braked},  // retracting
      {braked, braked, braked, braked, braked, braked},                      // braked
  }};
  const GuardState next = table[static_cast<std::size_t>(state)][static_cast<std::size_t>(asked)];
  return next == frozen && lasts ? held : next;
}

/// What is done in a state; at work a warning is given with what goes through.
[[nodiscard]] constexpr Action action_in(GuardState state, Action asked) {
  using enum Action;
  const std::array<Action, guard_states> done = {asked, freeze, freeze, comply, retract, brake};
  return done[static_cast<std::size_t>(state)];
}

}  // namespace tuina::safety
