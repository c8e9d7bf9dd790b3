// SPDX-License-Identifier: Apache-2.0
// What goes between the processes of a robot, whatever the others do.
#include "tuina/link/link.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "tests/folder.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/link/guard_process.hpp"
#include "tuina/link/linked_robot.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

using namespace tuina;
using namespace tuina::link;

namespace {

std::string own_name(const char* what) {
  return std::string("test-") + what + "-" + std::to_string(getpid());
}

robot::RobotReading some_reading() {
  robot::RobotReading reading{.time_s = 1.5, .tick = 1500, .rail_m = 0.25, .arms = {}};
  double number = 0.1;
  for (robot::ArmReading& arm : reading.arms.of) {
    arm.q_rad = JointVector::LinSpaced(7, number, number + 1.0);
    arm.dq_rad_per_s = -arm.q_rad;
    arm.wrench_in_tool = {Vector3(1.0, 2.0, number), Vector3(-1.0, 0.5, number)};
    arm.wrench_time_s = 1.499;
    arm.command_age = 3;
    if (number > 0.2) arm.measured_torque_nm = 2.0 * arm.q_rad;  // the first tells none
    number += 0.3;
  }
  return reading;
}

Arming some_arming() {
  Arming arming{.arm = robot::thesis_arm(), .mount = robot::mount_for(BodyPosture::prone)};
  arming.options.obstacles = arming.mount.obstacles;
  arming.options.max_set_force_n = 25.0;
  arming.options.leased = true;
  arming.options.field.columns = 3;
  arming.options.field.rows = 2;
  arming.options.field.cells.resize(6);
  arming.options.field.cells[4].zone = safety::Zone::muscle;
  return arming;
}

}  // namespace

TEST_CASE("a reading, a proposal and a verdict come out of their frames as they went in") {
  const robot::RobotReading reading = some_reading();
  const robot::RobotReading again = wire::from_frame(wire::to_frame(reading));
  CHECK(again.tick == reading.tick);
  CHECK(again.time_s == reading.time_s);
  CHECK(again.rail_m == reading.rail_m);
  for (const Arm arm : both_arms) {
    CHECK(again.arms[arm].q_rad == reading.arms[arm].q_rad);
    CHECK(again.arms[arm].dq_rad_per_s == reading.arms[arm].dq_rad_per_s);
    CHECK(again.arms[arm].wrench_in_tool.force_n == reading.arms[arm].wrench_in_tool.force_n);
    CHECK(again.arms[arm].wrench_in_tool.torque_nm == reading.arms[arm].wrench_in_tool.torque_nm);
    CHECK(again.arms[arm].wrench_time_s == reading.arms[arm].wrench_time_s);
    CHECK(again.arms[arm].command_age == reading.arms[arm].command_age);
    CHECK(again.arms[arm].measured_torque_nm == reading.arms[arm].measured_torque_nm);
  }
  safety::RobotProposal proposal{.rail_m = -0.1};
  proposal.arms[Arm::right] = {.torque_nm = JointVector::LinSpaced(6, 1.0, 2.0),
                               .phase = safety::Phase::contact,
                               .zone = safety::Zone::kidney,
                               .set_force_n = 17.0,
                               .normal_in_base = Vector3(0.6, 0.0, 0.8),
                               .virtual_target_in_base = Vector3(1.0, 2.0, 3.0),
                               .stiffness_n_per_m = 900.0};
  const wire::ProposalFrame frame = wire::to_frame(proposal, 42, true);
  CHECK(frame.answers_tick == 42);
  CHECK(frame.stop_asked == 1);
  const safety::RobotProposal proposed = wire::from_frame(frame);
  CHECK(proposed.rail_m == -0.1);
  CHECK(proposed.arms[Arm::left].torque_nm.size() == 0);
  const safety::Proposal& one = proposed.arms[Arm::right];
  CHECK(one.torque_nm == proposal.arms[Arm::right].torque_nm);
  CHECK(one.phase == safety::Phase::contact);
  CHECK(one.zone == safety::Zone::kidney);
  CHECK(one.set_force_n == 17.0);
  CHECK(one.normal_in_base == Vector3(0.6, 0.0, 0.8));
  CHECK(one.virtual_target_in_base == Vector3(1.0, 2.0, 3.0));
  CHECK(one.stiffness_n_per_m == 900.0);
  safety::RobotVerdict verdict;
  verdict.command.rail_m = 0.5;
  verdict.command.torque_nm[Arm::left] = JointVector::Constant(6, 3.0);
  verdict.command.brake[Arm::left] = true;
  verdict.arms[Arm::left] = {
      .action = safety::Action::brake, .cause = safety::Cause::encoder_jump, .latched = true};
  const safety::RobotVerdict judged = wire::from_frame(wire::to_frame(verdict, 7));
  CHECK(judged.command.rail_m == 0.5);
  CHECK(judged.command.torque_nm[Arm::left] == JointVector::Constant(6, 3.0));
  CHECK(judged.command.brake[Arm::left]);
  CHECK_FALSE(judged.command.brake[Arm::right]);
  CHECK(judged.arms[Arm::left].action == safety::Action::brake);
  CHECK(judged.arms[Arm::left].cause == safety::Cause::encoder_jump);
  CHECK(judged.arms[Arm::left].latched);
}

TEST_CASE("frames of random bytes become readings, proposals and verdicts that break nothing") {
  Random random = make_random(1, "wire");
  for (int i = 0; i < 20'000; ++i) {
    wire::SensorFrame sensed;
    wire::ProposalFrame proposed;
    wire::DriveFrame driven;
    const auto spoil = [&](auto& frame) {
      auto* bytes = reinterpret_cast<unsigned char*>(&frame);
      for (std::size_t k = 0; k < sizeof frame; ++k)
        bytes[k] = static_cast<unsigned char>(random());
    };
    spoil(sensed), spoil(proposed), spoil(driven);
    for (wire::SensorArm& arm : sensed.arms) arm.q_rad.count %= 12;
    for (wire::SensorArm& arm : sensed.arms) arm.measured_torque_nm.count %= 12;
    for (wire::DrivenArm& arm : driven.arms) arm.torque_nm.count %= 12;
    for (const robot::ArmReading& arm : wire::from_frame(sensed).arms.of)
      REQUIRE(std::max(arm.q_rad.size(), arm.measured_torque_nm.size()) <= max_joints);
    for (const safety::Proposal& arm : wire::from_frame(proposed).arms.of)
      REQUIRE(arm.torque_nm.size() <= max_joints);
    for (const safety::Verdict& arm : wire::from_frame(driven).arms.of) {
      REQUIRE(std::string(safety::name_of(arm.action)).size() > 1);
      REQUIRE(std::string(safety::name_of(arm.cause)).size() > 1);
    }
  }
}

TEST_CASE("a frame is read whole or not at all, while its writer writes on") {
  struct Many {
    std::array<std::uint64_t, 100> of = {};
  };
  Slot<Many> slot;
  CHECK_FALSE(slot.read().has_value());
  std::atomic<bool> ends = false;
  std::thread writer([&] {
    Many many;
    for (std::uint64_t i = 1; !ends; ++i) {
      many.of.fill(i);
      slot.write(many);
      if (i % 4 == 0) std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
  });
  std::uint64_t last = 0;
  int seen = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (seen < 20'000 && std::chrono::steady_clock::now() < deadline) {
    const auto many = slot.read();
    if (!many) continue;
    ++seen;
    for (const std::uint64_t one : many->of) REQUIRE(one == many->of.front());
    REQUIRE(many->of.front() >= last);
    last = many->of.front();
  }
  ends = true;
  writer.join();
  CHECK(seen == 20'000);
}

TEST_CASE("what one writes the others read; who only looks cannot write; nobody is waited for") {
  const std::string name = own_name("roles");
  CHECK_FALSE(Link::open(name, Role::drives).has_value());
  auto controller = Link::create(name, Role::controller);
  REQUIRE(controller.has_value());
  auto drives = Link::open(name, Role::drives);
  auto onlooker = Link::open(name, Role::onlooker);
  REQUIRE(drives.has_value());
  REQUIRE(onlooker.has_value());
  CHECK_FALSE(onlooker->sensors().has_value());
  drives->write(wire::to_frame(some_reading()));
  REQUIRE(onlooker->sensors().has_value());
  CHECK(onlooker->sensors()->tick == 1500);
  CHECK(controller->sensors()->tick == 1500);
  const auto began = std::chrono::steady_clock::now();
  const auto nothing = controller->wait_for(began + std::chrono::milliseconds(20),
                                            [&] { return controller->drive(); });
  CHECK_FALSE(nothing.has_value());
  const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - began;
  CHECK(waited.count() >= 0.02);
  CHECK(waited.count() < 20.0);
  *controller = Link();
  CHECK_FALSE(Link::open(name, Role::drives).has_value());
}

TEST_CASE("an arming is read as it was written; cut, spoilt or impossible, it arms nobody") {
  const test::Folder folder;
  const std::string file = folder / "person.arming";
  REQUIRE(write_arming(file, some_arming()).has_value());
  const auto read = read_arming(file);
  REQUIRE(read.has_value());
  CHECK(describe(*read) == describe(some_arming()));
  CHECK(read->arm.joints == robot::thesis_arm().joints);
  CHECK(read->arm.links[3].name == robot::thesis_arm().links[3].name);
  CHECK(read->options.max_set_force_n == 25.0);
  CHECK(read->options.leased);
  CHECK(read->options.obstacles.size() == some_arming().options.obstacles.size());
  CHECK(read->options.field.cells[4].zone == safety::Zone::muscle);

  const std::string bytes = read_file(file).value();
  for (std::size_t length = 0; length < bytes.size(); length += 7)
    CHECK_FALSE(parse_arming(bytes.substr(0, length), "cut").has_value());
  for (std::size_t at = 0; at < bytes.size(); at += 11) {
    std::string spoilt = bytes;
    spoilt[at] = static_cast<char>(spoilt[at] ^ 0x40);
    CHECK_FALSE(parse_arming(spoilt, "spoilt").has_value());
  }
  const std::vector<void (*)(Arming&)> impossible = {
      [](Arming& told) { told.arm.joints = 0; },
      [](Arming& told) { told.arm.joints = 8; },
      [](Arming& told) { told.arm.links[2].torque_limit_nm = std::nan(""); },
      [](Arming& told) { told.arm.links[2].torque_limit_nm = 0.0; },
      [](Arming& told) { told.options.field.columns = 4; },
      [](Arming& told) { told.options.field.cell_m = 0.0; },
      [](Arming& told) { told.options.field.up_in_base *= 2.0; },
      [](Arming& told) { told.options.field.cells[0].zone = static_cast<safety::Zone>(50); },
      [](Arming& told) { told.options.field.cells[0].normal_in_base.setZero(); },
      [](Arming& told) { told.options.max_set_force_n = std::nan(""); },
      [](Arming& told) { told.arm.tool_radius_m = 0.0; },
      [](Arming& told) { told.arm.tool_mass_kg = -1.0; },
      [](Arming& told) { told.arm.links[1].coulomb_nm = std::nan(""); },
      [](Arming& told) { told.mount.base_from_couch.translation().x() = HUGE_VAL; },
      [](Arming& told) { told.mount.rail_axis_in_base.setZero(); },
      [](Arming& told) { told.options.obstacles[0].edges_m.y() = -0.1; },
      [](Arming& told) { told.options.obstacles[0].edges_m.y() = HUGE_VAL; },
      [](Arming& told) {
        told.options.obstacles[0].base_from_box.translation().z() = std::nan("");
      },
      [](Arming& told) { told.options.obstacles[0].base_from_box.translation().z() = HUGE_VAL; },
      [](Arming& told) { told.options.obstacles[0].kind = static_cast<robot::Surrounding>(2); },
      [](Arming& told) { reinterpret_cast<unsigned char&>(told.options.bench) = 2; }};
  for (const auto& spoil : impossible) {
    Arming told = some_arming();
    spoil(told);
    REQUIRE(write_arming(file, told).has_value());
    const auto refused = read_arming(file);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().message.find("impossible") != std::string::npos);
  }
}

TEST_CASE(
    "arms that rest get a new guard, and the one before has ended; without a rest there is none") {
  const std::string name = own_name("rest");
  auto controller = Link::create(name, Role::controller);
  auto drives = Link::open(name, Role::drives);
  REQUIRE(drives.has_value());
  Arming arming{.arm = robot::thesis_arm(), .mount = robot::mount_for(BodyPosture::sitting)};
  const std::atomic<bool> ends = false;
  std::vector<std::thread> guards;
  LinkedRobot robot(std::move(*controller), Pace::max, [&](const Arming& told) -> Result<void> {
    guards.emplace_back([&, told] {
      auto link = Link::open(name, Role::guard);
      (void)keep_guard(*link, told, Pace::max, ends);
    });
    return {};
  });
  const auto sense = [&](std::uint64_t over) {
    wire::SensorFrame frame = wire::to_frame(some_reading());
    frame.over = over;
    drives->write(frame);
  };
  sense(0);
  REQUIRE(robot.arm(arming).has_value());
  CHECK(drives->drive()->guard == 0);
  CHECK(robot.arm(arming).error().message.find("one massage only") != std::string::npos);
  robot.rest();
  guards.front().join();
  CHECK(drives->stand()->guard == 1);
  CHECK(drives->drive()->guard == 0);  // so that the drives know that nobody guards now
  REQUIRE(robot.arm(arming).has_value());
  CHECK(drives->drive()->guard == 1);
  sense(1);
  guards.back().join();
}
