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

TEST_CASE("what a killed session has shared is taken away, and what a living one shares stays") {
  const std::string name = "test-left-" + std::to_string(getpid());
  const auto there = [&](const std::string& of) {
    return access(("/dev/shm/tuina-" + of + "-guard").c_str(), F_OK) == 0;
  };
  const auto living = Link::create(name, Role::controller);
  const auto with_it = Link::open(name, Role::drives);
  REQUIRE(with_it.has_value());
  Link::clear_left(name);
  CHECK(there(name));
  CHECK(living->maker_lives());
  CHECK(with_it->maker_lives());
  const std::string killed = name + "-killed";
  int made[2] = {};
  REQUIRE(pipe(made) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto link = Link::create(killed, Role::controller);
    (void)!write(made[1], "x", 1);
    pause();
  }
  char one = 0;
  REQUIRE(read(made[0], &one, 1) == 1);
  const auto guard = Link::open(killed, Role::guard);
  REQUIRE(guard.has_value());
  CHECK(guard->maker_lives());
  kill(child, SIGKILL);
  REQUIRE(waitpid(child, nullptr, 0) == child);
  CHECK_FALSE(guard->maker_lives());
  CHECK(there(killed));
  Link::clear_left(killed);
  CHECK_FALSE(there(killed));
  close(made[0]);
  close(made[1]);
}
