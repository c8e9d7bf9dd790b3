// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/serve/known_people.hpp"
#include "tuina/history/history.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::app {

/// What a session takes over from earlier ones, in words for people.
struct Remembered {
  std::string by_hand;  ///< what was said by hand; empty: nothing
  std::string lines;    ///< all of it, a line each
  std::vector<RememberedItem> items;
};

/// What a session takes over, and what only where somebody says so.
struct TakenOver {
  bool as_firm = false;  ///< force beyond the plan, where the last session ended so
  bool tissue = false;   ///< tissue of the last session, to probe by
  bool by_hand = true;   ///< places ruled out and points put right
  bool softer = true;    ///< less force than planned, where the last session ended so
};

/// Puts into an order what earlier sessions of somebody say for it: what was said by hand, wishes
/// and tissue. By itself a session begins softer than planned, never firmer. Fails as the database
/// does.
[[nodiscard]] Result<Remembered> remember(history::History& history, const std::string& who,
                                          const TakenOver& wanted, record::SessionOrder& order);

}  // namespace tuina::app
