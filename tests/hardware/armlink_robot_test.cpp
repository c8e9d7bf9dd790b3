// SPDX-License-Identifier: Apache-2.0
// A robot of two arms over UDP, whatever the arms say.
#include "tuina/hardware/armlink_robot.hpp"

#include <doctest/doctest.h>

#include "tests/allocation.hpp"
#include "tests/hardware/scripted_arms.hpp"
#include "tests/reason.hpp"
#include "tuina/robot/ready_posture.hpp"

using namespace tuina;
using namespace tuina::hardware;
using tuina::test::reason;
using tuina::tests::ScriptedArms;

namespace {

const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
const robot::ArmTable table = robot::thesis_arm();

robot::ReadyPose ready() {
  return {.q_rad = robot::ready_posture(table, mount), .rail_m = 0.1};
}

robot::RobotCommand still() {
  return {.torque_nm = {.of = {JointVector::Zero(6), JointVector::Zero(6)}}, .rail_m = 0.1};
}

struct Told {
  int readings = 0;
  std::string fault;
  double longest_s = 0.0;  ///< that one `read` took
  PerArm<int> aged = {};   ///< readings that tell of torques which were not the newest sent
};

/// Reads and applies until a fault, or so many readings.
Told drive(robot::Robot& robot, int readings) {
  Told told;
  for (int reads = 0; told.readings < readings && reads < 10 * readings; ++reads) {
    const auto before = std::chrono::steady_clock::now();
    const auto reading = robot.read();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    told.longest_s = std::max(told.longest_s, took.count());
    if (const char* fault = robot.fault()) {
      told.fault = fault;
      return told;
    }
    if (!reading) continue;
    ++told.readings;
    for (const Arm arm : both_arms) told.aged[arm] += reading->arms[arm].command_age == 1 ? 1 : 0;
    robot.apply(still());
  }
  return told;
}

/// What becomes of a session whose left arm's states the script spoils from the 20th on.
Told session(std::function<void(ScriptedArms::State&, std::vector<std::byte>&)> spoil,
             bool waits = true) {
  const auto later = [spoil](ScriptedArms::State& state, std::vector<std::byte>& bytes) {
    if (state.sequence >= 20) spoil(state, bytes);
  };
  ScriptedArms arms({.state = later, .waits = waits});
  auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  const auto stands = (*robot)->stand_ready(ready());
  REQUIRE_MESSAGE(stands.has_value(), reason(stands));
  return drive(**robot, 200);
}

void say(const ScriptedArms::State& state, std::vector<std::byte>& bytes) {
  const auto sent = armlink::encode(state);
  bytes.assign(sent.begin(), sent.end());
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a robot stands, tells its milliseconds without a gap and obeys, without heap") {
  ScriptedArms arms({});
  auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  CHECK((*robot)->simulated());
  CHECK((*robot)->peer(Arm::left).min_round_trip_s() > 0.0);
  CHECK_FALSE((*robot)->read().has_value());  // nobody has told it to stand
  REQUIRE((*robot)->stand_ready(ready()).has_value());
  const robot::RobotCommand command = still();
  const std::size_t before = test::allocations();
  for (std::uint64_t tick = 0; tick < 300; ++tick) {
    const auto reading = (*robot)->read();
    REQUIRE(reading.has_value());
    REQUIRE(reading->tick == tick);
    (*robot)->apply(command);
    if (tick != 299) continue;
    CHECK(test::allocations() == before);
    CHECK(reading->time_s == doctest::Approx(0.299));
    CHECK(reading->rail_m == 0.1);
    for (const Arm arm : both_arms) {
      CHECK(reading->arms[arm].q_rad == ready().q_rad[arm]);
      CHECK(reading->arms[arm].wrench_time_s == doctest::Approx(0.298));
    }
  }
  CHECK((*robot)->fault() == nullptr);
  CHECK((*robot)->peer(Arm::left).traffic().lost == 0);
  CHECK((*robot)->peer(Arm::left).traffic().unheard == 0);
  CHECK(arms.obeyed() >= 598);  // the last ones may be under way
}

TEST_CASE("commands that reach an arm too late are counted, and the session goes on") {
  ScriptedArms arms({.state = [](ScriptedArms::State& state, std::vector<std::byte>& bytes) {
    if (state.sequence % 10 == 5) --state.answers, say(state, bytes);
  }});
  auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  REQUIRE((*robot)->stand_ready(ready()).has_value());
  const Told told = drive(**robot, 60);
  CHECK_MESSAGE(told.fault.empty(), told.fault);
  CHECK((*robot)->peer(Arm::left).traffic().unheard == 6);
  CHECK(told.aged[Arm::left] == 6);
  CHECK(told.aged[Arm::right] == 0);
  CHECK((*robot)->peer(Arm::right).traffic().unheard == 0);
}

TEST_CASE("arms that rest go on where they were") {
  ScriptedArms arms({});
  auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  REQUIRE((*robot)->stand_ready(ready()).has_value());
  CHECK(drive(**robot, 50).readings == 50);
  (*robot)->rest();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const auto reading = (*robot)->read();
  REQUIRE(reading.has_value());
  CHECK(reading->tick == 50);
  (*robot)->apply(still());
  CHECK(drive(**robot, 50).readings == 50);
}

TEST_CASE("arms that rest stay their host's, and their clocks may drift apart meanwhile") {
  std::atomic<double> ahead_s = 0.0;
  const auto drifted = [&](ScriptedArms::State& state, std::vector<std::byte>& bytes) {
    state.time_s += ahead_s;
    state.wrench_time_s += ahead_s;
    say(state, bytes);
  };
  ScriptedArms arms({.state = drifted});
  auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  REQUIRE((*robot)->stand_ready(ready()).has_value());
  CHECK(drive(**robot, 50).readings == 50);
  (*robot)->rest();
  const auto before = arms.commands();
  for (int i = 1; i <= 6; ++i) {
    ahead_s = 1e-3 * i;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  CHECK(arms.commands() > before + 5);
  const auto reading = (*robot)->read();
  REQUIRE(reading.has_value());
  for (const Arm arm : both_arms)
    CHECK(reading->time_s - reading->arms[arm].wrench_time_s < 1.5e-3);
  (*robot)->apply(still());
  CHECK(drive(**robot, 50).readings == 50);
  CHECK((*robot)->fault() == nullptr);
}

TEST_CASE("where nobody listens, or somebody else does, it is said within two seconds") {
  PerArm<ArmDevice> nobody;
  {
    ScriptedArms gone({});
    nobody = gone.file();
  }
  const auto begun = std::chrono::steady_clock::now();
  const auto robot = ArmlinkRobot::open(nobody, table, mount);
  REQUIRE_FALSE(robot.has_value());
  CHECK(has(robot.error().message, "nobody answers"));
  CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(2));
  // Two programs cannot be the same arm.
  ScriptedArms arms({});
  CHECK_FALSE(UdpSocket::listen(arms.file()[Arm::left].udp).has_value());
}

TEST_CASE("an arm that falls silent is told of to the guard first, and given up then") {
  const Told told =
      session([](ScriptedArms::State&, std::vector<std::byte>& bytes) { bytes.clear(); }, false);
  CAPTURE(told.fault);
  CHECK(has(told.fault, "the left arm is silent"));
  CHECK(told.readings <= 120);  // 20 of both, the others of the right arm alone
  CHECK(told.longest_s < 1.0);
}
