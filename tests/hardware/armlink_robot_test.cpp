// SPDX-License-Identifier: Apache-2.0
// A robot of two arms over UDP, whatever the arms say.
#include "tuina/hardware/armlink_robot.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "tests/allocation.hpp"
#include "tests/hardware/scripted_arms.hpp"
#include "tests/reason.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

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

/// Why no robot is opened when the left arm says this of itself.
std::string refused(std::function<void(armlink::Hello&)> hello) {
  ScriptedArms arms({.hello = std::move(hello)});
  const auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  REQUIRE_FALSE(robot.has_value());
  CHECK(robot.error().fault == Fault::device);
  CHECK(robot.error().message.find("the left arm at " + arms.file()[Arm::left].address) == 0);
  return robot.error().message;
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

TEST_CASE("an arm that is less than its table is refused, with both numbers") {
  using armlink::Hello;
  CHECK(has(refused([](Hello& hello) { hello.max_torque_nm[2] = 69.5; }),
            "gives 69.5 Nm at upper_arm_roll, the table believes in 70"));
  CHECK(has(refused([](Hello& hello) { hello.max_speed_rad_per_s[0] = 0.1; }), "0.1 rad/s"));
  CHECK(has(refused([](Hello& hello) { hello.max_rad[5] = 1.0; }), "turns wrist from"));
  CHECK(has(refused([](Hello& hello) { hello.max_rail_m = 0.0; }), "moves its base from"));
  CHECK(has(refused([](Hello& hello) { hello.flags = 0; }), "has no linear base"));
  CHECK(has(refused([](Hello& hello) { hello.flags |= armlink::flag::busy; }),
            "is driven by another host"));
  CHECK(has(refused([](Hello& hello) { hello.modes = 8; }), "cannot be driven by torques"));
  CHECK(has(refused([](Hello& hello) { hello.cycle_us = 2000; }), "2000 us, 1000 are needed"));
  CHECK(has(refused([](Hello& hello) {
              for (JointVector* limit : {&hello.max_torque_nm, &hello.max_speed_rad_per_s,
                                         &hello.min_rad, &hello.max_rad})
                limit->conservativeResize(5);
            }),
            "has 5 joints, the table 6"));
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

TEST_CASE("whatever an arm says wrongly has a name, and nothing hangs") {
  using State = ScriptedArms::State;
  using Bytes = std::vector<std::byte>;
  const auto named = [](const Told& told, const char* fault) {
    CAPTURE(told.fault);
    CHECK(has(told.fault, fault));
    CHECK(told.readings == 20);  // what was good before
    CHECK(told.longest_s < 5.0);
  };
  named(session([](State&, Bytes& bytes) { bytes.assign(300, std::byte{7}); }),
        "the left arm sends what is no armlink");
  named(session([](State&, Bytes& bytes) { bytes[100] ^= std::byte{1}; }), "wrong check sums");
  named(session([](State&, Bytes& bytes) { bytes[4] = std::byte{2}; }), "another version");
  named(session([](State&, Bytes& bytes) { bytes.pop_back(); }), "of a wrong size");
  named(session([](State& state, Bytes& bytes) {
          state.dq_rad_per_s[2] = std::numeric_limits<double>::quiet_NaN(), say(state, bytes);
        }),
        "numbers that are not finite");
  named(session([](State& state, Bytes& bytes) {
          for (JointVector* vector : {&state.q_rad, &state.dq_rad_per_s, &state.tau_nm})
            vector->conservativeResize(5);
          say(state, bytes);
        }),
        "another number of joints");
  named(session([](State& state, Bytes& bytes) { state.sequence -= 10, say(state, bytes); }),
        "counts its states backwards");
  named(session([](State& state, Bytes& bytes) { state.time_s += 3600.0, say(state, bytes); }),
        "has a clock that jumps");
  named(session([](State& state, Bytes& bytes) { ++state.session, say(state, bytes); }),
        "obeys another host as well");
  named(session([](State& state, Bytes& bytes) { state.answers -= 11, say(state, bytes); }),
        "does not hear its commands");
  named(session([](State& state, Bytes& bytes) {
          state.status = armlink::status::emergency_stop, say(state, bytes);
        }),
        "was stopped by an emergency stop");
  named(session([](State& state, Bytes& bytes) {
          state.status = armlink::status::drive_fault, say(state, bytes);
        }),
        "has a fault in its drives");
  named(session([](State& state, Bytes& bytes) {
          state.status = armlink::status::stopped, say(state, bytes);
        }),
        "has stopped by itself");
}

TEST_CASE("an arm that falls silent is told of to the guard first, and given up then") {
  const Told told =
      session([](ScriptedArms::State&, std::vector<std::byte>& bytes) { bytes.clear(); }, false);
  CAPTURE(told.fault);
  CHECK(has(told.fault, "the left arm is silent"));
  CHECK(told.readings <= 120);  // 20 of both, the others of the right arm alone
  CHECK(told.longest_s < 1.0);
}
