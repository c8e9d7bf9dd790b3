// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/session/live_command.hpp"

namespace tuina::web {

/// All that a page may ask for. The commands of a running massage have the names of
/// `session::LiveCommand`.
enum class Ask : std::uint8_t {
  beat,             ///< somebody is still there
  operate,          ///< be the operator
  hand_over,        ///< be the operator no longer
  invite,           ///< an address that opens the page for one more, who may watch and stop
  invite_operator,  ///< the same for one who may take control, too
  start,            ///< begin a session, by the order that the message holds
  change,           ///< another plan, by the order that the message holds
  hold,             ///< the button that arms goes down
  arm,              ///< it was held long enough: the arms may move
  pause,
  resume,
  stop,
  skip,
  repeat,
  softer,
  firmer,
};
inline constexpr std::array<const char*, 16> ask_names = {
    "beat",  "operate", "hand_over", "invite", "invite_operator", "start",  "change", "hold", "arm",
    "pause", "resume",  "stop",      "skip",   "repeat",          "softer", "firmer"};
[[nodiscard]] constexpr const char* name_of(Ask ask) noexcept {
  return ask_names[static_cast<std::size_t>(ask)];
}
/// The command of a running massage that an ask stands for; nothing for the other asks.
[[nodiscard]] std::optional<session::LiveCommand> live_command(Ask ask) noexcept;

/// One message of a page.
struct Message {
  Ask ask = Ask::beat;
  std::uint64_t sequence = 0;  ///< greater than that of the message before
  double clock_s = 0.0;        ///< the server's clock, as the page believes it to be when it asks
  std::string order;           ///< JSON object of `start` or `change`
  /// Count of the plan shown, `reviews` of the state: that of `change`, `hold` and `arm`.
  std::optional<std::uint64_t> review;
};
inline constexpr std::size_t max_message_bytes = 64 << 10;

/// Reads {"ask": "pause", "sequence": 7, "clock_s": 12.3}, with "order" for `start` and `change`,
/// and "review" where the page says which plan it shows.
/// Whatever else is refused with the key and what stands there.
[[nodiscard]] Result<Message> parse_message(std::string_view text);

}  // namespace tuina::web
