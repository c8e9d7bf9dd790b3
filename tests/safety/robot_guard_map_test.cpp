// SPDX-License-Identifier: Apache-2.0
// A robot that is guarded by a map of a person.
#include "tests/allocation.hpp"
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
