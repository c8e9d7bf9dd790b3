// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "apps/serve/known_people.hpp"
#include "apps/simulated/session_order.hpp"

namespace tuina::app {

/// What a page orders of a session: names that are built in and numbers within limits, no paths.
struct StartOrder {
  SessionOrder order;
  int intensity = 3;  ///< 1 to 5; a factor on every force, as for a programme
  std::uint64_t seed = 1;
  std::string consent_toml;  ///< answers to the health questions
  std::string who;           ///< a pseudonym; empty: no history
  Confirmed confirmed = {};  ///< what is remembered of them
};

/// Reads the JSON object of `start`. Whatever is missing, unknown or out of range is refused with
/// its key. Answers are only read, not judged: `session::parse_consent` does that.
[[nodiscard]] Result<StartOrder> parse_start_order(std::string_view text);

/// JSON object of what may be chosen, for the page of a server that keeps a history of people, or
/// none.
[[nodiscard]] std::string choices_json(bool keeps_people);

}  // namespace tuina::app
