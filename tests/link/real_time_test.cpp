// SPDX-License-Identifier: Apache-2.0
// Who gets real-time priority: the thread that controls arms at real pace, while they are armed.
#include "tuina/link/real_time.hpp"

#include <doctest/doctest.h>
#include <sched.h>
#include <unistd.h>

#include <thread>

#include "tuina/link/linked_robot.hpp"

using namespace tuina;
using namespace tuina::link;

namespace {

int policy() {
  return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
}

int policy_of_new_thread() {
  int found = -1;
  std::thread([&found] { found = policy(); }).join();
  return found;
}

/// What this machine grants to a thread that asks.
int granted_policy() {
  int found = -1;
  std::thread([&found] {
    const std::string said = be_real_time(Priority::loop);
    found = policy();
    CHECK((said.find("priority real-time") != std::string::npos) == (found == SCHED_FIFO));
    CHECK(policy_of_new_thread() == SCHED_OTHER);
    end_real_time();
    CHECK(policy() == SCHED_OTHER);
  }).join();
  return found;
}

}  // namespace

TEST_CASE("the control thread is a real-time one while arms are armed at real pace, and only it") {
  const int granted = granted_policy();
  if (granted != SCHED_FIFO) MESSAGE("this machine grants no real-time priority");
  for (const Pace pace : {Pace::real, Pace::max}) {
    const std::string name = "test-real-time-" + std::to_string(getpid());
    auto controller = Link::create(name, Role::controller);
    auto guard = Link::open(name, Role::guard);
    REQUIRE(guard.has_value());
    {
      LinkedRobot robot(std::move(*controller), pace, [&guard](const Arming&) -> Result<void> {
        const auto wish = guard->stand();
        guard->write(wire::DriveFrame{.armed = 1, .guard = wish ? wish->guard : 0});
        return {};
      });
      const int armed = pace == Pace::real ? granted : SCHED_OTHER;
      REQUIRE(robot.arm({}).has_value());
      CHECK(policy() == armed);
      CHECK(policy_of_new_thread() == SCHED_OTHER);
      robot.rest();
      CHECK(policy() == SCHED_OTHER);
      REQUIRE(robot.arm({}).has_value());
      CHECK(policy() == armed);
    }
    CHECK(policy() == SCHED_OTHER);  // a robot that is gone leaves no thread before all others
  }
}
