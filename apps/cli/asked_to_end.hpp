// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace tuina::app {

/// What a second Ctrl-C or SIGTERM does: nothing where arms depend on the program, as those of a
/// guard do.
enum class AskedAgain : std::uint8_t { ends_at_once, is_nothing_new };

/// From here on Ctrl-C, SIGTERM and a terminal that is closed (SIGHUP) set what `asked_to_end`
/// gives, and end nothing else the first time; a terminal that is closed is told twice and ends
/// nothing the second time, nor does a pipe that nobody reads any more (SIGPIPE). What whoever
/// began the program has silenced, as nohup does, stays so.
void end_when_asked(AskedAgain again = AskedAgain::ends_at_once);
[[nodiscard]] const std::atomic<bool>& asked_to_end();

}  // namespace tuina::app
