// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/faulty_robot.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "tests/fake_robot.hpp"

using namespace tuina;
using namespace tuina::sim;
using robot::RobotReading;
using tests::FakeRobot;

namespace {

constexpr int onset_ms = 10;

/// What comes of readings 0 to `last_ms` when a fault begins at the tenth.
std::vector<std::optional<RobotReading>> readings(TimedFault fault, int last_ms = 40) {
  FakeRobot fake({.wrench_n = {-30.0, 1.0, 2.0}});
  JointVector q(6);
  q << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
  REQUIRE(fake.stand_ready({.q_rad = {.of = {q, q}}}).has_value());
  FaultyRobot robot(fake);
  fault.onset_s = onset_ms * 1e-3;
  robot.add(fault);
  std::vector<std::optional<RobotReading>> all;
  while (robot.time_s() < last_ms * 1e-3 - 1e-9) all.push_back(robot.read());
  return all;
}

const robot::ArmReading& left(const std::optional<RobotReading>& reading) {
  return reading->arms[Arm::left];
}

}  // namespace

TEST_CASE("before its onset a fault changes nothing, and the other arm never has it") {
  for (const RobotFault kind : {RobotFault::wrench_nan, RobotFault::encoder_nan}) {
    const auto all = readings({.kind = kind});
    CHECK(left(all[onset_ms - 1]).wrench_in_tool.force_n.x() == -30.0);
    CHECK(left(all[onset_ms - 1]).q_rad[0] == 0.1);
    CHECK(
        std::isnan(left(all[onset_ms]).wrench_in_tool.force_n.x() * left(all[onset_ms]).q_rad[0]));
    CHECK(all[onset_ms]->arms[Arm::right].wrench_in_tool.force_n.x() == -30.0);
    CHECK(all[onset_ms]->arms[Arm::right].q_rad[0] == 0.1);
  }
}

TEST_CASE("a wrist sensor that drops out gets older, one that is stuck does not") {
  const auto dropped = readings({.kind = RobotFault::wrench_dropout});
  CHECK(left(dropped[20]).wrench_time_s == doctest::Approx(onset_ms * 1e-3));
  const auto stuck = readings({.kind = RobotFault::wrench_stuck});
  CHECK(left(stuck[20]).wrench_time_s == doctest::Approx(20e-3));
}

TEST_CASE("a wrist sensor lies by as much as it is told: spikes, bias, drift, sign and range") {
  const auto felt = [](const TimedFault& fault, int ms) {
    return left(readings(fault)[static_cast<std::size_t>(ms)]).wrench_in_tool.force_n;
  };
  const TimedFault spikes = {.kind = RobotFault::wrench_spikes, .size = 500.0, .rate_hz = 100.0};
  CHECK(felt(spikes, 10).x() == 470.0);
  CHECK(felt(spikes, 11).x() == -30.0);
  CHECK(felt(spikes, 20).x() == 470.0);
  CHECK(felt({.kind = RobotFault::wrench_bias, .part = 1, .size = 10.0}, 30).y() == 11.0);
  CHECK(felt({.kind = RobotFault::wrench_drift, .size = 100.0}, 30).x() == doctest::Approx(-28.0));
  CHECK(felt({.kind = RobotFault::wrench_flip}, 30).x() == 30.0);
  CHECK(felt({.kind = RobotFault::wrench_saturation, .size = 20.0}, 30) == Vector3(-20, 1, 2));
}

TEST_CASE("clocks stand still or jump while the ticks go on") {
  const auto stopped = readings({.kind = RobotFault::clock_stopped});
  CHECK(stopped[30]->time_s == doctest::Approx(onset_ms * 1e-3));
  CHECK(left(stopped[30]).wrench_time_s == doctest::Approx(onset_ms * 1e-3));
  CHECK(stopped[30]->tick == 30);
  CHECK(readings({.kind = RobotFault::clock_jump, .size = -3600.0})[30]->time_s ==
        doctest::Approx(-3599.97));
}

TEST_CASE("a stall leaves readings out, lost ones are missing, doubled ones come twice") {
  const auto stalled = readings({.kind = RobotFault::stall, .duration_s = 5e-3});
  CHECK(stalled[onset_ms - 1]->tick == 9);
  CHECK(stalled[onset_ms]->tick == 15);
  CHECK(stalled[onset_ms + 1]->tick == 16);
  const auto lost = readings({.kind = RobotFault::readings_lost, .duration_s = 5e-3});
  CHECK_FALSE(lost[14].has_value());
  CHECK(lost[15]->tick == 15);
  const auto doubled = readings({.kind = RobotFault::readings_doubled});
  CHECK(doubled[10]->tick == 9);
  CHECK(doubled[11]->tick == 11);
  CHECK(doubled[12]->tick == 11);
}

TEST_CASE("drives turn torques weak, round or noisy, and dead guards command nothing") {
  const auto applied = [](const TimedFault& fault) {
    FakeRobot fake;
    FaultyRobot robot(fake);
    robot.add(fault);
    (void)robot.read();
    JointVector torque_nm = JointVector::Constant(6, 3.0);
    robot.apply({.torque_nm = {.of = {torque_nm, torque_nm}}});
    return fake;
  };
  const FakeRobot reversed =
      applied({.kind = RobotFault::drive_gain, .arm = Arm::right, .part = 2, .size = -1.0});
  CHECK(reversed.last.torque_nm[Arm::right][2] == -3.0);
  CHECK(reversed.last.torque_nm[Arm::right][1] == 3.0);
  CHECK(reversed.last.torque_nm[Arm::left][2] == 3.0);
  const JointVector noisy =
      applied({.kind = RobotFault::drive_noise, .size = 0.5}).last.torque_nm[Arm::left];
  CHECK((noisy.array() != 3.0).all());
  CHECK(noisy.mean() == doctest::Approx(3.0).epsilon(0.5));
  CHECK(applied({.kind = RobotFault::commands_lost}).applied == 0);
  const TimedFault hot = {.kind = RobotFault::drives_fade, .size = 0.5, .onset_s = -2.0};
  CHECK(applied(hot).last.torque_nm[Arm::left][0] == 1.5);
  CHECK(applied(hot).last.torque_nm[Arm::right][0] == 3.0);
}

TEST_CASE("a weak motor turns less than the current says that its drive measures") {
  for (const RobotFault kind : {RobotFault::motor_gain, RobotFault::drive_gain}) {
    FakeRobot fake({.measures_torque = true});
    FaultyRobot robot(fake);
    robot.add({.kind = kind, .part = 1, .size = 0.5});
    robot.add({.kind = kind, .part = 9, .size = 0.5});  // no such joint
    (void)robot.read();
    JointVector torque_nm = JointVector::Constant(6, 3.0);
    robot.apply({.torque_nm = {.of = {torque_nm, torque_nm}}});
    CHECK(fake.last.torque_nm[Arm::left][1] == 1.5);
    const auto reading = robot.read();
    CHECK(left(reading).measured_torque_nm[1] == (kind == RobotFault::motor_gain ? 3.0 : 1.5));
    CHECK(left(reading).measured_torque_nm[0] == 3.0);
    CHECK(reading->arms[Arm::right].measured_torque_nm[1] == 3.0);
  }
}
