// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/control_loop.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/fake_robot.hpp"

using namespace tuina;
using tests::FakeRobot;

namespace {

constexpr int planned_ticks = 50;

/// Runs the loop for so many readings; what it fails with, or nothing.
std::string drive(FakeRobot& robot, int& seen) {
  const auto step = [&](const robot::RobotReading& reading) -> std::optional<robot::RobotCommand> {
    ++seen;
    return robot::RobotCommand{.torque_nm = {}, .rail_m = reading.time_s};
  };
  const auto look = [&](const robot::RobotReading&, const robot::RobotCommand&) {
    return seen < planned_ticks;
  };
  const auto driven = session::run_control_loop(robot, step, look);
  return driven ? "" : driven.error().message;
}

}  // namespace

TEST_CASE("each reading is answered once, and the loop ends when it is told to") {
  FakeRobot robot;
  int seen = 0;
  CHECK(drive(robot, seen).empty());
  CHECK(seen == planned_ticks);
  CHECK(robot.applied == planned_ticks);
  CHECK(robot.last.rail_m == doctest::Approx((planned_ticks - 1) * control_period_s));
}

TEST_CASE("a few readings that do not come are borne, ten in a row end the loop") {
  int seen = 0;
  FakeRobot stutters({.silent_from = 20, .silent_for = 9});
  CHECK(drive(stutters, seen).empty());
  CHECK(seen == planned_ticks);

  seen = 0;
  FakeRobot silent({.silent_from = 20});
  CHECK(drive(silent, seen) == "the robot has given no reading for 10 ms");
  CHECK(seen == 20);
  CHECK(silent.applied == 20);
}

TEST_CASE("a fault of the device ends the loop with the device's own words, before a command") {
  FakeRobot hot({.fault_at = 7});
  int seen = 0;
  CHECK(drive(hot, seen) == "the robot: drive 3 is too hot");
  CHECK(seen == 7);
  CHECK(hot.applied == 7);
}
