// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>

#include "tuina/core/ring.hpp"
#include "tuina/session/live_command.hpp"

namespace tuina::session {

/// Live commands on their way from one thread, of who steers, to the session's. A stop goes before
/// all others, and once.
class CommandQueue {
 public:
  /// False: too many wait already, and it was not taken.
  [[nodiscard]] bool push(LiveCommand command) noexcept { return commands_.push(command); }
  void stop() noexcept { stop_ = true; }
  [[nodiscard]] bool stopped() const noexcept { return stop_; }

  /// The next command; called by the session's thread only.
  [[nodiscard]] std::optional<LiveCommand> next() noexcept {
    if (stop_ && !stop_told_) {
      stop_told_ = true;
      return LiveCommand::stop;
    }
    LiveCommand command = {};
    if (!commands_.pop(command)) return std::nullopt;
    return command;
  }
  /// Forgets all, between two sessions.
  void clear() noexcept {
    LiveCommand left = {};
    while (commands_.pop(left)) continue;
    stop_ = stop_told_ = false;
  }

 private:
  Ring<LiveCommand, 64> commands_;
  std::atomic<bool> stop_ = false;
  bool stop_told_ = false;
};

}  // namespace tuina::session
