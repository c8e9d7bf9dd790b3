// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/control_loop.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/fake_robot.hpp"
#include "tuina/robot/ready_posture.hpp"

using namespace tuina;
using tests::FakeRobot;

namespace {

constexpr int planned_ticks = 50;

/// Runs the loop for so many readings; what it fails with, or nothing.
std::string drive(FakeRobot& robot, int& seen) {
  const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
  const robot::ArmTable table = robot::thesis_arm();
  REQUIRE(robot.stand_ready({.q_rad = robot::ready_posture(table, mount)}).has_value());
  const PerArm<robot::ArmModel> models = robot::both_models(table, mount);
  safety::RobotGuard guard(models, {});
  const auto propose = [&](const robot::RobotReading& reading) {
    ++seen;
    safety::RobotProposal still;
    for (const Arm arm : both_arms)
      still.arms[arm].torque_nm = models[arm].gravity_nm(reading.arms[arm].q_rad);
    return still;
  };
  const auto look = [&](const robot::RobotReading& reading, const safety::RobotVerdict& verdict) {
    for (const Arm arm : both_arms)
      CHECK(
          verdict.command.torque_nm[arm].isApprox(models[arm].gravity_nm(reading.arms[arm].q_rad)));
    return seen < planned_ticks;
  };
  const auto driven = session::run_control_loop(robot, guard, propose, look);
  return driven ? "" : driven.error().message;
}

}  // namespace

TEST_CASE("each reading is answered once, and the loop ends when it is told to") {
  FakeRobot robot;
  int seen = 0;
  CHECK(drive(robot, seen).empty());
  CHECK(seen == planned_ticks);
  CHECK(robot.applied == planned_ticks);
  CHECK(robot.last.torque_nm[Arm::left].size() == robot::thesis_arm().joints);
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
