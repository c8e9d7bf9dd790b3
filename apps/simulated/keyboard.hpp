// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <termios.h>

#include "tuina/session/live_command.hpp"

namespace tuina::app {

inline constexpr const char* key_help =
    "space: pause and resume, s: stop, n: skip, r: repeat, -: softer, +: firmer";

/// Live commands from the keyboard, or from whatever is on standard input; a terminal gives every
/// key at once, without Enter and without showing it, until this object ends.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  /// The next command, if a key for one was pressed; never waits.
  [[nodiscard]] std::optional<session::LiveCommand> read() noexcept;

 private:
  bool terminal_ = false;
  bool paused_ = false;
  termios before_ = {};
};

}  // namespace tuina::app
