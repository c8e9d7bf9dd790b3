// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tuina/session/earlier/by_hand.hpp"

namespace tuina::app {

/// Reads the JSON object of `change`: "no_go" (name and corners) and "fixed" (name and at), places
/// in m in the couch frame. Whatever is missing, unknown, not finite or out of range is refused
/// with its key.
[[nodiscard]] Result<session::ByHand> parse_plan_change(std::string_view text);
/// The same object, written.
[[nodiscard]] std::string plan_change_json(const session::ByHand& by_hand);

}  // namespace tuina::app
