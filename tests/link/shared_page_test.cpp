// SPDX-License-Identifier: Apache-2.0
// Whose the memory of a link is.
#include "tuina/link/shared_page.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tuina/link/link.hpp"

using namespace tuina::link;

TEST_CASE(
    "a link is one session's: nobody takes it meanwhile, and what a killed one left is none") {
  const std::string name = "test-owned-" + std::to_string(getpid());
  auto first = Link::create(name, Role::controller);
  REQUIRE(first.has_value());
  const auto second = Link::create(name, Role::controller);
  REQUIRE_FALSE(second.has_value());
  CHECK(second.error().message.find("a session of this name runs") != std::string::npos);
  CHECK(Link::open(name, Role::guard).has_value());
  // A process that is killed takes nothing away, and holds nothing any more.
  const pid_t child = fork();
  if (child == 0) {
    const auto killed = Link::create(name + "-killed", Role::controller);
    raise(SIGKILL);
  }
  REQUIRE(waitpid(child, nullptr, 0) == child);
  CHECK(access(("/dev/shm/tuina-" + name + "-killed-guard").c_str(), F_OK) == 0);
  CHECK_FALSE(Link::open(name + "-killed", Role::guard).has_value());
  CHECK(Link::create(name + "-killed", Role::controller).has_value());
}
