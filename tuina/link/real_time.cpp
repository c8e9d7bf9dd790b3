// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/real_time.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

namespace tuina::link {

std::string be_real_time(Priority priority) {
  const bool locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  const sched_param wanted = {.sched_priority = static_cast<int>(priority)};
  const bool first = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0;
  return fmt::format("memory {}, priority {}", locked ? "locked" : "not locked",
                     first ? "real-time" : "as any other process");
}

void end_real_time() noexcept {
  const sched_param usual = {};
  // Who is not root may lower the priority, but may not take back that a child begins without it.
  (void)sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &usual);
  (void)munlockall();
}

}  // namespace tuina::link
