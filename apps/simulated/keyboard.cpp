// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

namespace tuina::app {

using session::LiveCommand;

Keyboard::Keyboard() {
  terminal_ = ::tcgetattr(STDIN_FILENO, &before_) == 0;
  if (!terminal_) return;
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

Keyboard::~Keyboard() {
  if (terminal_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

std::optional<LiveCommand> Keyboard::read() noexcept {
  for (;;) {
    pollfd waiting{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    char key = 0;
    if (::poll(&waiting, 1, 0) != 1 || ::read(STDIN_FILENO, &key, 1) != 1) return std::nullopt;
    switch (key) {
      case ' ':
        paused_ = !paused_;
        return paused_ ? LiveCommand::pause : LiveCommand::resume;
      case 's':
        return LiveCommand::stop;
      case 'n':
        return LiveCommand::skip;
      case 'r':
        return LiveCommand::repeat;
      case '-':
        return LiveCommand::softer;
      case '+':
        return LiveCommand::firmer;
      default:
        break;  // other keys mean nothing
    }
  }
}

}  // namespace tuina::app
