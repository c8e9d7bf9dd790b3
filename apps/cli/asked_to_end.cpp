// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/asked_to_end.hpp"

#include <array>
#include <csignal>

namespace tuina::app {
namespace {

std::atomic<bool> ends = false;

struct Heard {
  int signal;
  bool taken = false;  ///< by `hear`
};
std::array<Heard, 3> heard = {{{SIGINT}, {SIGTERM}, {SIGHUP}}};

bool second_ends = false;

void hear(int) {
  ends = true;
  if (!second_ends) return;
  // A terminal that is closed is told twice, by its shell and by the kernel: nobody has asked
  // again.
  for (const Heard& one : heard)
    if (one.taken && one.signal != SIGHUP) (void)std::signal(one.signal, SIG_DFL);
}

}  // namespace

void end_when_asked(AskedAgain again) {
  second_ends = again == AskedAgain::ends_at_once;
  // Who reads along may leave, as `| head` does; arms that move do not hang on it.
  (void)std::signal(SIGPIPE, SIG_IGN);
  for (Heard& one : heard) {
    one.taken = true;
    if (std::signal(one.signal, hear) != SIG_IGN) continue;
    one.taken = false;
    (void)std::signal(one.signal, SIG_IGN);
  }
}

const std::atomic<bool>& asked_to_end() {
  return ends;
}

}  // namespace tuina::app
