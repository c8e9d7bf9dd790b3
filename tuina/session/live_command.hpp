// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tuina::session {

/// What may be asked for while a massage runs, from the keyboard or a page alike.
enum class LiveCommand : std::uint8_t {
  pause,   ///< stay where the tools are, with a light touch
  resume,  ///< go on
  stop,    ///< let go, and end
  skip,    ///< leave what is being done now for what comes next
  repeat,  ///< what is being done now once more
  softer,  ///< less force from now on
  firmer,  ///< more, within the caps
};
inline constexpr std::array<const char*, 7> live_command_names = {
    "pause", "resume", "stop", "skip", "repeat", "softer", "firmer"};
/// Name of a command, as pages and records have it.
[[nodiscard]] constexpr const char* name_of(LiveCommand command) noexcept {
  return live_command_names[static_cast<std::size_t>(command)];
}

}  // namespace tuina::session
