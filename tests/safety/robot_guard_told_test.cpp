// SPDX-License-Identifier: Apache-2.0
// What the guard of a robot is told by others than its controller: a map of a person, and to stop.
#include "tests/allocation.hpp"
#include "tests/safety/scene.hpp"
#include "tests/safety/standing_robot.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// The skin before both tools, in the plane x = 0.4: muscle to the left of the middle, bone to the
/// right, 0.5 m wide and 0.1 m high.
ZoneField back_before() {
  ZoneField field{.corner_in_base = {0.4, -0.25, -0.35},
                  .along_in_base = Vector3::UnitY(),
                  .up_in_base = Vector3::UnitZ(),
                  .cell_m = 5e-3,
                  .columns = 100,
                  .rows = 20};
  for (int i = 0; i < 2000; ++i)
    field.cells.push_back({i % 100 < 50 ? Zone::bony : Zone::muscle, -Eigen::Vector3f::UnitX()});
  return field;
}

}  // namespace

TEST_CASE("each arm is guarded by the place under the foremost point of its tool") {
  StandingRobot robot({.field = back_before()});
  robot.press(Arm::left, 20.0);
  robot.press(Arm::right, 20.0);
  robot.tick(10);
  CHECK(robot.action(Arm::left) == Action::pass);
  CHECK(robot.cause(Arm::right) == Cause::set_force_too_high);
}

TEST_CASE("beside the map all is denied, whatever the controller calls it") {
  ZoneField field = back_before();
  field.corner_in_base.z() += 0.2;
  StandingRobot robot({.field = field});
  robot.press(Arm::left, 5.0);
  robot.tick(10);
  CHECK(robot.cause(Arm::left) == Cause::set_force_too_high);
  StandingRobot travelling({.field = field});
  CHECK(travelling.tick(100).arms[Arm::left].action == Action::pass);
}

TEST_CASE("a person may have shifted by 15 mm since the map was made") {
  for (const double from_border_m : {14e-3, 21e-3}) {
    ZoneField field = back_before();
    field.corner_in_base.y() += 0.2 + from_border_m;  // the left tool is that far in the bone
    StandingRobot robot({.field = field});
    robot.press(Arm::left, 20.0);
    robot.tick(10);
    CHECK((robot.action(Arm::left) == Action::pass) == (from_border_m < 15e-3));
  }
}

TEST_CASE("guarding a robot takes no memory from the heap") {
  robot::Obstacle couch{.edges_m = {2.0, 2.0, 0.1}};
  couch.base_from_box.translation().z() = -1.0;
  StandingRobot robot({.obstacles = {couch}, .field = back_before()});
  robot.press(Arm::left, 20.0);
  const auto before = test::allocations();
  robot.tick(100);
  robot.guard.stop(Cause::asked_to);
  robot.tick(100);
  CHECK(test::allocations() == before);
}

TEST_CASE("an arm that still presses 0.3 s after somebody asked it to stop leaves") {
  for (const double felt_n : {1.99, 2.01, 20.0}) {
    StandingRobot robot;
    robot.press(Arm::left, felt_n);
    robot.tick(10);
    robot.guard.expect_stop();
    robot.tick(200);
    robot.guard.expect_stop();  // asking again gives no more time
    robot.tick(99);
    CHECK(robot.action(Arm::left) == Action::pass);
    robot.tick();
    CHECK(robot.action(Arm::left) == (felt_n > 2.0 ? Action::retract : Action::pass));
    if (felt_n > 2.0) CHECK(robot.cause(Arm::left) == Cause::asked_to);
    robot.tick(10);
    CHECK(robot.action(Arm::right) == Action::pass);
  }
  StandingRobot late;  // who lets go and presses again has not stopped
  late.press(Arm::left, 0.0);
  late.tick(10);
  late.guard.expect_stop();
  CHECK(late.tick(1000).arms[Arm::left].action == Action::pass);
  late.press(Arm::left, 20.0);
  late.tick(5);
  CHECK(late.cause(Arm::left) == Cause::asked_to);
  StandingRobot again;  // nor does asking once more, after the time is over, give any
  again.press(Arm::left, 0.0);
  again.tick(10);
  again.guard.expect_stop();
  again.tick(400);
  again.guard.expect_stop();
  again.press(Arm::left, 20.0);
  again.tick(5);
  CHECK(again.cause(Arm::left) == Cause::asked_to);
  StandingRobot nobody;  // nobody has asked
  nobody.press(Arm::left, 20.0);
  CHECK(nobody.tick(1000).arms[Arm::left].action == Action::pass);
}

TEST_CASE("a stop in a hand or of the operator makes both arms leave at once, leased or not") {
  for (const Watcher watcher : {Watcher::operating, Watcher::hand_stop}) {
    for (const bool leased : {false, true}) {
      StandingRobot robot({.leased = leased});
      robot.press(Arm::left, 20.0);
      robot.tick(10);
      robot.guard.hear(watcher, {.beat = 1});
      CHECK(robot.tick().arms[Arm::left].action == Action::pass);
      robot.guard.hear(watcher, {.beat = 1, .stop = true});
      robot.tick();
      for (const Arm arm : both_arms) {
        CHECK(robot.action(arm) == Action::retract);
        CHECK(robot.cause(arm) == Cause::asked_to);
      }
    }
  }
}

TEST_CASE("both arms leave when operator or hand stop are silent for half a second") {
  // Beats of the one every so many ticks, of the other in each.
  const auto watched = [](Watcher slow, std::uint64_t every_ticks, bool leased) {
    StandingRobot robot({.leased = leased});
    const Watcher other = slow == Watcher::operating ? Watcher::hand_stop : Watcher::operating;
    robot.press(Arm::left, 20.0);
    for (std::uint64_t ms = 1; ms <= 1010; ++ms) {
      robot.guard.hear(slow, {.beat = ms / every_ticks});
      robot.guard.hear(other, {.beat = -ms});  // any change is a sign of life
      robot.tick();
    }
    return robot.verdict;
  };
  for (const Watcher slow : {Watcher::operating, Watcher::hand_stop}) {
    const RobotVerdict in_time = watched(slow, 500, true);
    const RobotVerdict over = watched(slow, 501, true);
    const RobotVerdict not_leased = watched(slow, 5000, false);
    for (const Arm arm : both_arms) {
      CHECK(in_time.arms[arm].action == Action::pass);
      CHECK(over.arms[arm].latched);
      CHECK(over.arms[arm].cause == Cause::lease_over);
      CHECK(not_leased.arms[arm].action == Action::pass);
    }
  }
}

TEST_CASE("a watcher that has not begun to count gives no sign of life") {
  StandingRobot robot({.leased = true});
  robot.press(Arm::left, 20.0);
  robot.tick(400);
  for (const Watcher watcher : {Watcher::operating, Watcher::hand_stop})
    robot.guard.hear(watcher, {});
  CHECK(robot.tick(100).arms[Arm::left].action == Action::pass);
  CHECK(robot.tick().arms[Arm::left].cause == Cause::lease_over);
}

TEST_CASE("an arm that presses leaves the skin, whatever its controller calls that") {
  for (const Phase phase : {Phase::contact, Phase::retract, Phase::free}) {
    for (const double felt_n : {4.9, 5.1, 20.0}) {
      StandingRobot robot;
      robot.press(Arm::left, felt_n);
      robot.tick(20);
      robot.proposal.arms[Arm::left].phase = phase;
      if (phase != Phase::contact) robot.proposal.arms[Arm::left].set_force_n = 0.0;
      if (phase == Phase::free) robot.reading.arms[Arm::left].dq_rad_per_s.setConstant(0.02);
      robot.reading.arms[Arm::right].q_rad[3] = not_a_number;
      robot.tick();
      const bool told = phase == Phase::contact;
      CHECK(robot.action(Arm::left) == (told || felt_n > 5.0 ? Action::retract : Action::freeze));
    }
  }
}

TEST_CASE("a body is under the tools while either of them feels one") {
  for (const bool left : {false, true}) {
    for (const bool right : {false, true}) {
      StandingRobot robot;
      if (left) robot.press(Arm::left, 20.0);
      if (right) robot.press(Arm::right, 20.0);
      robot.tick(10);
      CHECK(robot.guard.pressed() == (left || right));
    }
  }
}
