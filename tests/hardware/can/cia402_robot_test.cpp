// SPDX-License-Identifier: Apache-2.0
// Two arms of drives on CAN: begun, moved, driven by torques, ended.
#include "tuina/hardware/can/cia402_robot.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "tests/allocation.hpp"
#include "tests/hardware/can/emulated_robot.hpp"
#include "tests/reason.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/can/drive_setup.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

using namespace tuina;
using namespace tuina::hardware;
using tuina::app::EmulatedDrive;
using tuina::test::reason;
using tuina::tests::EmulatedRobot;
using Clock = std::chrono::steady_clock;

namespace {

/// The thesis' arm on a base that stands.
const robot::RobotMount mount = [] {
  robot::RobotMount standing = robot::mount_for(BodyPosture::sitting);
  standing.min_rail_m = standing.max_rail_m = 0.0;
  return standing;
}();
const robot::ArmTable table = robot::thesis_arm();

robot::ReadyPose ready() {
  return {.q_rad = {.of = {JointVector::Constant(6, 10_deg), JointVector::Constant(6, -10_deg)}}};
}

robot::RobotCommand torques(double left_elbow_nm) {
  robot::RobotCommand command;
  command.torque_nm = {.of = {JointVector::Zero(6), JointVector::Zero(6)}};
  command.torque_nm[Arm::left][3] = left_elbow_nm;
  return command;
}

std::unique_ptr<Cia402Robot> opened(EmulatedRobot& drives) {
  auto robot = Cia402Robot::open(drives.file(), table, mount, drives.buses());
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  return std::move(*robot);
}

EmulatedDrive& elbow(std::deque<EmulatedDrive>& drives) {
  return drives[3];
}

}  // namespace

TEST_CASE("drives stand ready together, then torque goes in and position comes out, without heap") {
  constexpr double inertia_kg_m2 = 0.5, torque_nm = 6.0;
  EmulatedRobot drives({.setup = [](EmulatedDrive& d) { d.inertia_kg_m2 = inertia_kg_m2; }});
  const auto robot = opened(drives);
  CHECK_FALSE(robot->read().has_value());  // nobody has told it to stand
  const auto stands = robot->stand_ready(ready());
  REQUIRE_MESSAGE(stands.has_value(), reason(stands));
  const auto begun = robot->read();
  REQUIRE(begun.has_value());
  for (const Arm arm : both_arms)
    CHECK((begun->arms[arm].q_rad - ready().q_rad[arm]).norm() < 1e-4);
  CHECK(begun->tick == 0);
  constexpr int cycles = 100;
  const robot::RobotCommand command = torques(torque_nm);
  robot->apply(command);
  const std::size_t before = test::allocations();
  std::optional<robot::RobotReading> reading;
  for (int i = 1; i <= cycles; ++i) {
    reading = robot->read();
    REQUIRE_MESSAGE(reading.has_value(), (robot->fault() != nullptr ? robot->fault() : "silent"));
    robot->apply(command);
  }
  CHECK(test::allocations() == before);
  CHECK(reading->tick == cycles);
  CHECK(reading->arms[Arm::left].command_age == 1);
  REQUIRE(reading->arms[Arm::left].measured_torque_nm.size() == table.joints);
  CHECK(reading->arms[Arm::left].measured_torque_nm[3] == doctest::Approx(torque_nm).epsilon(0.02));
  // The first command changes the drive to torques, and all count from the next SYNC on.
  const double speed = torque_nm / inertia_kg_m2 * 1e-3 * cycles;
  CHECK(reading->arms[Arm::left].dq_rad_per_s[3] == doctest::Approx(speed).epsilon(0.05));
  CHECK(reading->arms[Arm::left].q_rad[3] - 10_deg ==
        doctest::Approx(0.5 * speed * 1e-3 * cycles).epsilon(0.05));
  CHECK(reading->arms[Arm::right].dq_rad_per_s.norm() == 0.0);
  CHECK(robot->fault() == nullptr);
}

TEST_CASE("a reversed drive turns as its joint does, and no torque passes the limit of the table") {
  EmulatedRobot drives;
  const auto robot = opened(drives);
  REQUIRE(robot->stand_ready(ready()).has_value());
  // Within what a drive may be off its order: nothing of this is beyond the limit but the order.
  for (int i = 0; i < 10; ++i) {
    REQUIRE(robot->read().has_value());
    robot->apply(torques(1000.0));
  }
  REQUIRE(robot->read().has_value());
  drives.look([](auto& all) {
    const double limit_nm = table.links[3].torque_limit_nm;
    const auto given = static_cast<std::int16_t>(elbow(all).value(0x6077));
    CHECK(elbow(all).device().reversed);
    CHECK(1e-3 * given * 60.0 == doctest::Approx(-limit_nm).epsilon(0.001));
    CHECK(elbow(all).value(0x6072) == doctest::Approx(limit_nm / 0.06).epsilon(0.001));
    CHECK((elbow(all).value(0x1801, 1) >> 31U) == 1);  // a PDO that nobody asked for is silent
  });
}

TEST_CASE("brakes close when they are ordered to and open again, one arm by itself") {
  EmulatedRobot drives;
  const auto robot = opened(drives);
  REQUIRE(robot->stand_ready(ready()).has_value());
  const auto drive = [&](bool brake, int cycles) {
    robot::RobotCommand command = torques(0.0);
    command.brake[Arm::left] = brake;
    for (int i = 0; i < cycles; ++i) {
      REQUIRE_MESSAGE(robot->read().has_value(), (robot->fault() ? robot->fault() : "silent"));
      robot->apply(command);
    }
    return drives.look([](auto& all) { return std::pair(elbow(all).enabled(), all[9].enabled()); });
  };
  CHECK(drive(false, 20) == std::pair(true, true));
  CHECK(drive(true, 20) == std::pair(false, true));
  CHECK(drive(false, 20) == std::pair(true, true));
}

TEST_CASE("a torque that is no number reaches no drive") {
  EmulatedRobot drives;
  const auto robot = opened(drives);
  REQUIRE(robot->stand_ready(ready()).has_value());
  REQUIRE(robot->read().has_value());
  robot->apply(torques(std::numeric_limits<double>::quiet_NaN()));
  REQUIRE(robot->fault() != nullptr);
  CHECK(std::string(robot->fault()) == "the left elbow was ordered a torque that is no number");
}

TEST_CASE("the session ends with closed brakes") {
  EmulatedRobot drives;
  {
    const auto robot = opened(drives);
    REQUIRE(robot->stand_ready(ready()).has_value());
    REQUIRE(robot->read().has_value());
    robot->apply(torques(0.0));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  drives.look([](auto& all) {
    for (EmulatedDrive& drive : all) CHECK_FALSE(drive.enabled());
  });
}

TEST_CASE("drives whose host falls silent stop by themselves, and the next session resets them") {
  EmulatedRobot drives({.every = [](EmulatedDrive& d) { d.host_patience_ms = 0; }});
  {
    const auto robot = opened(drives);
    REQUIRE(robot->stand_ready(ready()).has_value());
    REQUIRE(robot->read().has_value());
    // Until the first command they stand without their host.
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    drives.look([](auto& all) { CHECK(elbow(all).enabled()); });
    REQUIRE(robot->read().has_value());
    robot->apply(torques(0.0));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    drives.look([](auto& all) {
      for (EmulatedDrive& drive : all) {
        CHECK_FALSE(drive.enabled());
        CHECK(drive.value(0x603F) == 0x8130);
      }
    });
    CHECK_FALSE(robot->read().has_value());
    REQUIRE(robot->fault() != nullptr);
    CHECK(std::string(robot->fault()).find("it heard no heartbeat of its host") !=
          std::string::npos);
  }
  // A drive that is still at fault is reset once, when the next session sets it up.
  EmulatedRobot again({.setup = [](EmulatedDrive& d) { d.fall_into_fault(0x8130); }});
  CHECK(opened(again)->stand_ready(ready()).has_value());
}

TEST_CASE("while nobody commands the arms stand on their brakes, and their host lives") {
  constexpr int patience_ms = 1000;  // with a thread on a busy machine
  EmulatedRobot drives({.every = [](EmulatedDrive& d) { d.host_patience_ms = patience_ms; }});
  const auto robot = opened(drives);
  REQUIRE(robot->stand_ready(ready()).has_value());
  robot->rest();  // before the first command they need no host, and stay as they are
  REQUIRE(robot->read().has_value());
  drives.look([](auto& all) { CHECK(elbow(all).enabled()); });
  const auto drive = [&](int cycles) {
    std::uint64_t tick = 0;
    for (int i = 0; i < cycles; ++i) {
      robot->apply(torques(0.0));
      const auto reading = robot->read();
      REQUIRE_MESSAGE(reading.has_value(), (robot->fault() ? robot->fault() : "silent"));
      tick = reading->tick;
    }
    return tick;
  };
  const std::uint64_t tick = drive(20);
  robot->rest();
  std::this_thread::sleep_for(std::chrono::milliseconds(3 * patience_ms));
  drives.look([](auto& all) {
    for (EmulatedDrive& one : all) {
      CHECK_FALSE(one.enabled());
      CHECK(one.value(0x603F) == 0);  // no fault, as it would be of one that misses its host
    }
  });
  const auto reading = robot->read();
  REQUIRE_MESSAGE(reading.has_value(), (robot->fault() ? robot->fault() : "silent"));
  CHECK(reading->tick == tick + 1);
  CHECK(drive(20) == tick + 21);
  drives.look([](auto& all) {
    for (EmulatedDrive& one : all) CHECK(one.obeys_torques());
  });
}

TEST_CASE("what goes wrong while nobody commands is told by the next reading") {
  const auto told = [](const auto& happens) {
    EmulatedRobot drives;
    const auto robot = opened(drives);
    REQUIRE(robot->stand_ready(ready()).has_value());
    for (int i = 0; i < 20; ++i) {
      REQUIRE(robot->read().has_value());
      robot->apply(torques(0.0));
    }
    robot->rest();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    drives.look([&](auto& all) { happens(all, drives); });
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    CHECK_FALSE(robot->read().has_value());
    return std::string(robot->fault() != nullptr ? robot->fault() : "nothing");
  };
  CHECK(told([](auto&, EmulatedRobot& drives) { drives.unplug(); }) ==
        "the bus can1 was unplugged");
  CHECK(told([](auto& all, EmulatedRobot&) {
          elbow(all).report(0x4210);
        }).starts_with("the left elbow reports error 0x4210"));
  CHECK(told([](auto& all, EmulatedRobot&) {
          elbow(all).say_heartbeat(0);
        }).starts_with("the left elbow has begun anew"));
}

TEST_CASE("at real pace a millisecond of the readings is one of the host's clock") {
  // Emulated drives answer when this machine lets them; a busy one makes them silent, and no more.
  std::uint64_t tick = 0;
  for (int tries = 0; tries < 3 && tick < 1000; ++tries) {
    EmulatedRobot drives(
        {.every = [](EmulatedDrive& d) { d.host_patience_ms = 5000; }, .waits = false});
    const auto robot = opened(drives);
    std::string fault;
    if (const auto stands = robot->stand_ready(ready()); !stands) fault = stands.error().message;
    const auto begun = Clock::now();
    for (tick = 0; fault.empty() && tick < 1000;) {
      const auto reading = robot->read();
      if (robot->fault() != nullptr) fault = robot->fault();
      if (!reading) continue;
      tick = reading->tick;
      robot->apply(torques(0.0));
    }
    const std::chrono::duration<double> took = Clock::now() - begun;
    CHECK_MESSAGE((fault.empty() || fault.ends_with(" is silent")), fault);
    constexpr double late_s = 0.2;
    CHECK(std::abs(took.count() - 1e-3 * static_cast<double>(tick)) < late_s);
  }
  MESSAGE(tick << " of 1000 milliseconds at real pace");
}

TEST_CASE("who a drive is can be asked without moving it") {
  EmulatedRobot drives({.setup = [](EmulatedDrive& d) { d.place_at(20_deg); }});
  auto bus = drives.buses().open("can1");
  REQUIRE(bus.has_value());
  const auto found = find_drive(*bus, drives.file()[Arm::left].joints[3]);
  REQUIRE_MESSAGE(found.has_value(), reason(found));
  CHECK(found->vendor == 0xFB);
  CHECK(found->serial == 1004);
  CHECK(found->state == cia402::State::switch_on_disabled);
  CHECK(found->joint_rad == doctest::Approx(20_deg).epsilon(1e-4));
}
