// SPDX-License-Identifier: Apache-2.0
// What the drives of the simulated robot do when nobody commands them, and what a brake is.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "tests/allocation.hpp"
#include "tests/reason.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/sim/robot/plant.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
const robot::ArmTable table = robot::thesis_arm();
const PerArm<robot::ArmModel> models = robot::both_models(table, mount);

PerArm<JointVector> bent() {
  JointVector q(6);
  q << 0.5, 0.4, 0.3, 0.2, -0.3, 0.4;
  return {.of = {q, robot::mirrored(table, mount, q)}};
}

/// Both arms held against their weight, the left tool pushed ahead with so much.
robot::RobotCommand hold(const robot::RobotReading& reading, double push_n = 0.0) {
  robot::RobotCommand command;
  for (const Arm arm : both_arms) {
    const robot::ArmReading& seen = reading.arms[arm];
    const robot::ArmDynamics dynamics = models[arm].evaluate(seen.q_rad, seen.dq_rad_per_s, 0.0);
    const Vector3 force_n(arm == Arm::left ? push_n : 0.0, 0.0, 0.0);
    command.torque_nm[arm] = dynamics.gravity_nm - 2.0 * seen.dq_rad_per_s +
                             dynamics.jacobian.topRows<3>().transpose() * force_n;
  }
  return command;
}

struct Room {
  std::unique_ptr<BackContact> skin;
  std::unique_ptr<Plant> plant;

  [[nodiscard]] const ArmTruth& left() const { return plant->truth().arms[Arm::left]; }
  void live(int ms, double push_n = 0.0) {
    for (int i = 0; i < ms; ++i) plant->apply(hold(*plant->read(), push_n));
  }
  void leave_alone(int ms) {
    for (int i = 0; i < ms; ++i) (void)plant->read();
  }
};

/// A robot whose left tool stands 1 mm before a patch of hard muscle.
Room enter(const PlantOptions& options = {}) {
  const Vector3 tool_in_couch =
      mount.base_from_couch.inverse() *
      Vector3(models[Arm::left].base_from_tool(bent()[Arm::left], 0.0).translation());
  const Mesh mesh =
      make_patch({.centre_in_couch = tool_in_couch - Vector3(-0.1, 18e-3, 0.0), .size_m = 0.3});
  Room room{.skin = std::make_unique<BackContact>(
                mesh, std::vector<TangentTissue>(mesh.vertices.size(), {9.786, 185.4})),
            .plant = nullptr};
  auto plant =
      Plant::make(mount, {.of = {table, table}}, {.q_rad = bent()}, room.skin.get(), options);
  REQUIRE_MESSAGE(plant.has_value(), test::reason(plant));
  room.plant = std::move(*plant);
  return room;
}

}  // namespace

TEST_CASE("an arm in the air whose commands stop is damped from 20 ms on, braked 300 ms later") {
  Room room = enter();
  room.live(50);
  const Vector3 at = room.left().couch_from_tool.translation();
  room.leave_alone(20);
  CHECK(room.left().drive == Drive::commanded);
  room.leave_alone(298);
  CHECK(room.left().drive == Drive::damped);
  room.live(2);  // somebody comes back in time
  CHECK(room.left().drive == Drive::commanded);
  room.leave_alone(318);
  CHECK(room.left().drive == Drive::damped);
  room.leave_alone(5);
  CHECK(room.left().drive == Drive::braked);
  room.leave_alone(1000);
  CHECK((room.left().couch_from_tool.translation() - at).norm() < 2e-3);
  room.live(10);  // commands that come too late are not obeyed
  CHECK(room.left().drive == Drive::braked);
}

TEST_CASE("a tool that presses is let go of before it is braked") {
  Room room = enter();
  room.live(1500, 40.0);
  const double pressed_n = room.left().contact.force_n;
  REQUIRE(pressed_n > 30.0);
  room.leave_alone(30);
  CHECK(room.left().drive == Drive::damped);
  room.leave_alone(320);
  CHECK(room.left().drive == Drive::braked);
  CHECK(room.left().contact.force_n < 0.4 * pressed_n);  // friction of the gears keeps the rest
}

TEST_CASE("an arm that nobody commands is not braked while somebody pushes it along, for 2 s") {
  Room room = enter();
  room.live(50);
  room.plant->push(Arm::left, {.force_n = {0.0, 0.0, 40.0}});
  room.leave_alone(1000);
  CHECK(room.left().drive == Drive::damped);
  room.leave_alone(1030);
  CHECK(room.left().drive == Drive::braked);
}

TEST_CASE("who comes back in time is obeyed again") {
  Room room = enter();
  room.live(1500, 40.0);
  room.leave_alone(50);
  CHECK(room.left().drive == Drive::damped);
  room.live(2, 40.0);
  CHECK(room.left().drive == Drive::commanded);
}

TEST_CASE("a watchdog that is switched off lets the last torques go on") {
  Room room = enter({.watchdog_ticks = 0});
  room.live(1500, 40.0);
  room.leave_alone(1000);
  CHECK(room.left().drive == Drive::commanded);
  CHECK(room.left().contact.force_n > 30.0);
}

TEST_CASE("a braked arm meets a hand with its stiffness, slips under a blow, and is let go again") {
  Room room = enter();
  room.live(50);
  const auto braked = [&](int ms, double hand_n) {
    room.plant->push(Arm::left, {.force_n = {0.0, 0.0, -hand_n}});
    for (int i = 0; i < ms; ++i) {
      robot::RobotCommand command = hold(*room.plant->read());
      command.brake[Arm::left] = true;
      room.plant->apply(command);
    }
    return room.left().couch_from_tool.translation();
  };
  const Vector3 at = braked(10, 0.0);
  CHECK((braked(300, 100.0) - at).norm() < 2e-3);
  CHECK((braked(300, 0.0) - at).norm() < 1e-3);
  CHECK((braked(300, 2000.0) - at).norm() > 10e-3);
  room.plant->push(Arm::left, {});
  room.live(20);
  CHECK(room.left().drive == Drive::commanded);
}

TEST_CASE("an arm that loses its power sinks for 50 ms, then its brakes hold it") {
  Room room = enter();
  room.live(100);
  const Vector3 at = room.left().couch_from_tool.translation();
  room.plant->cut_power(Arm::left);
  room.live(40);
  CHECK(room.left().drive == Drive::off);
  room.live(15);
  CHECK(room.left().drive == Drive::braked);
  const Vector3 caught = room.left().couch_from_tool.translation();
  room.live(500);
  MESSAGE(fmt::format("it sank by {:.1f} mm", 1e3 * (caught - at).norm()));
  CHECK((caught - at).norm() < 20e-3);
  CHECK((room.left().couch_from_tool.translation() - caught).norm() < 3e-3);
  CHECK(room.plant->truth().arms[Arm::right].drive == Drive::commanded);
}

TEST_CASE("an emergency stop lets both arms give way at once, then brakes them for good") {
  Room room = enter();
  room.live(100);
  const Vector3 at = room.left().couch_from_tool.translation();
  room.plant->emergency_stop();
  room.live(1);
  const auto both_are = [&](Drive drive) {
    const auto& arms = room.plant->truth().arms;
    return arms[Arm::left].drive == drive && arms[Arm::right].drive == drive;
  };
  CHECK(both_are(Drive::damped));
  room.live(310);
  CHECK(both_are(Drive::braked));
  const double sunk_m = (room.left().couch_from_tool.translation() - at).norm();
  MESSAGE(fmt::format("it sank by {:.2f} mm", 1e3 * sunk_m));
  CHECK(sunk_m < 2e-3);
  room.live(1000);
  CHECK(both_are(Drive::braked));
}

TEST_CASE("watchdog and brakes take nothing from the heap") {
  Room room = enter();
  room.live(50, 40.0);
  const auto before = test::allocations();
  room.leave_alone(400);
  CHECK(test::allocations() == before);
  CHECK(room.plant->fault() == nullptr);
}
