// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_sensor.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "tests/allocation.hpp"
#include "tests/hardware/scripted_arms.hpp"
#include "tests/hardware/scripted_wrist.hpp"
#include "tests/reason.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/steady_clock.hpp"
#include "tuina/hardware/wrist_robot.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/safety/guard.hpp"

using namespace tuina;
using namespace std::chrono_literals;
using hardware::WristDevice;
using hardware::WristSample;
using hardware::WristSensor;
using hardware::WristStream;
using test::reason;
using tests::ScriptedArms;
using tests::ScriptedWrist;
using Kind = ScriptedWrist::Kind;
using Clock = std::chrono::steady_clock;

namespace {

WristSample sample(std::uint32_t number) {
  return {.sequence = number,
          .counter = number,
          .status = 0,
          .counts = {static_cast<std::int32_t>(number % 7), 0, 0, 0, 0, 0}};
}

const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
const robot::ArmTable table = robot::thesis_arm();

/// Arms that stand still and give a reading each millisecond of the host's clock.
class StillArms final : public robot::Robot {
 public:
  Result<void> stand_ready(const robot::ReadyPose& pose) override {
    for (const Arm arm : both_arms) {
      reading_.arms[arm].q_rad = pose.q_rad[arm];
      reading_.arms[arm].dq_rad_per_s = JointVector::Zero(table.joints);
      reading_.arms[arm].wrench_in_tool.force_n = Vector3(7.0, 0.0, 0.0);
    }
    return {};
  }
  std::optional<robot::RobotReading> read() noexcept override {
    if (next_ == Clock::time_point{}) next_ = Clock::now();
    std::this_thread::sleep_until(next_ += 1ms);
    ++reading_.tick;
    reading_.time_s += 1e-3;
    for (robot::ArmReading& arm : reading_.arms.of) arm.wrench_time_s = reading_.time_s;
    return reading_;
  }
  void apply(const robot::RobotCommand&) noexcept override {}
  const char* fault() const noexcept override { return nullptr; }

 private:
  robot::RobotReading reading_;
  Clock::time_point next_ = {};
};

robot::ReadyPose ready() {
  return {.q_rad = robot::ready_posture(table, mount), .rail_m = 0.0};
}

}  // namespace

TEST_CASE("counts become a wrench about the tool's origin, in the tool's axes") {
  WristDevice device{.kind = Kind::hex_serial};
  device.counts_per_n = {10.0, 20.0, 40.0};
  device.counts_per_nm.setConstant(100.0);
  device.tool_from_sensor_turn =
      Eigen::AngleAxisd(90.0_deg, Vector3::UnitZ()).toRotationMatrix();  // its x is the tool's y
  device.sensor_in_tool_m = {-0.1, 0.0, 0.0};
  device.calibration =
      hardware::WristCalibration{.mass_kg = 0.2, .offset_in_tool = {.force_n = {0, 0, 1}}};
  WristSample one = sample(1);
  one.counts = {20, 60, -80, 0, 0, 50};  // 2, 3, -2 N and 0.5 Nm about z
  for (const bool reversed : {false, true}) {
    device.reversed = reversed;
    WristStream stream(device);
    REQUIRE(stream.take(one, 5.0));
    const double sign = reversed ? -1.0 : 1.0;
    const Vector3 force_n = sign * Vector3(-3.0, 2.0, -2.0);
    CHECK(stream.in_tool().force_n.isApprox(force_n - Vector3(0, 0, 1), 1e-12));
    // The sensor stands behind the tool by 0.1 m: (-0.1, 0, 0) x f is (0, 0.1 fz, -0.1 fy).
    const Vector3 torque_nm(0.0, 0.1 * force_n.z(), sign * 0.5 - 0.1 * force_n.y());
    CHECK(stream.in_tool().torque_nm.isApprox(torque_nm, 1e-12));
    CHECK(stream.time_s() == 5.0);
  }
}

TEST_CASE("a few lost, doubled and late samples are borne, counted, and never new") {
  WristStream stream({.kind = Kind::hex_serial});
  REQUIRE(stream.take(sample(65530), 1.000));
  CHECK(stream.take(sample(65531), 1.001));
  CHECK_FALSE(stream.take(sample(65531), 1.002));
  CHECK(stream.take(sample(65535), 1.005));
  CHECK_FALSE(stream.take(sample(65533), 1.006));
  CHECK(stream.take(sample(2), 1.008));  // 16 bits turn over
  CHECK(stream.time_s() == doctest::Approx(1.008));
  CHECK(stream.traffic().lost == 5);
  CHECK(stream.traffic().again == 1);
  CHECK(stream.traffic().late == 1);
  CHECK(stream.fault() == nullptr);
}

TEST_CASE("a sample that was held up is as old as its number says, not as its arrival") {
  WristStream stream({.kind = Kind::ati_udp});
  REQUIRE(stream.take(sample(1), 2.0));
  for (std::uint32_t i = 2; i <= 11; ++i) stream.take(sample(i), 2.050);  // ten come 50 ms late
  CHECK(stream.time_s() == doctest::Approx(2.011).epsilon(1e-4));
  for (std::uint32_t i = 12; i <= 600; ++i) stream.take(sample(i), 2.0 + 1e-3 * (i - 1));
  CHECK(stream.time_s() == doctest::Approx(2.599).epsilon(1e-6));  // in time again
}

TEST_CASE("each kind of sensor is set up by the bytes of its document, and stopped at the end" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  for (const Kind kind : {Kind::hex_serial, Kind::hex_udp, Kind::ati_udp}) {
    ScriptedWrist wrist({.kind = kind});
    {
      WristDevice device = wrist.device();
      device.filter = kind == Kind::ati_udp ? 0 : 2;
      const auto sensor = WristSensor::open(device);
      REQUIRE_MESSAGE(sensor.has_value(), reason(sensor));
      CHECK(sensor->measured_rate_hz() == doctest::Approx(1000.0).epsilon(0.08));
      CHECK(sensor->stream().in_tool().force_n.isApprox(Vector3(2.0, -4.0, 6.0), 0.03));
    }
    std::this_thread::sleep_for(20ms);
    using Bytes = ScriptedWrist::Bytes;
    const auto told = wrist.told();
    const Bytes& last = told.back();
    if (kind == Kind::hex_serial) {
      CHECK(told.front() == Bytes{0xAA, 0x00, 0x32, 0x03, 1, 2, 0, 0x00, 0xE2});
      CHECK(last == Bytes{0xAA, 0x00, 0x32, 0x03, 0, 2, 0, 0x00, 0xE1});
      continue;
    }
    const Bytes stop = {0x12, 0x34, 0, 0, 0, 0, 0, 0}, start = {0x12, 0x34, 0, 2, 0, 0, 0, 0};
    CHECK(told.front() == stop);
    CHECK(last == stop);
    CHECK(std::find(told.begin(), told.end(), start) != told.end());
    const Bytes filter = {0x12, 0x34, 0, 0x81, 0, 0, 0, 2},
                period = {0x12, 0x34, 0, 0x82, 0, 0, 0, 1};
    const Bytes unbias = {0x12, 0x34, 0, 0x42, 0, 0, 0, 0};
    for (const Bytes& request : {filter, period, unbias})
      CHECK((std::find(told.begin(), told.end(), request) != told.end()) ==
            (kind == Kind::hex_udp));
  }
}

TEST_CASE("the wrench of an arm is its sensor's, of the other arm what that arm says") {
  ScriptedWrist wrist({.kind = Kind::ati_udp});
  StillArms arms;
  auto robot =
      hardware::WristRobot::open(arms, {.of = {std::nullopt, wrist.device()}}, table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  REQUIRE((*robot)->stand_ready(ready()).has_value());
  // Zeroed at the start: what is left is the weight of the tool, turned as the tool stands.
  const auto model = robot::both_models(table, mount)[Arm::right];
  const Vector3 weight_n(0.0, 0.0, -table.tool_mass_kg * gravity_m_per_s2);
  const Vector3 expected_n =
      model.base_from_tool(ready().q_rad[Arm::right], 0.0).linear().transpose() * weight_n;
  double last_s = -1.0;
  int fresh = 0, stale = 0;
  for (int i = 0; i < 300; ++i) {
    const auto before = test::allocations();
    const auto reading = (*robot)->read();
    CHECK(test::allocations() == before);
    REQUIRE(reading.has_value());
    CHECK(reading->arms[Arm::left].wrench_in_tool.force_n == Vector3(7.0, 0.0, 0.0));
    const robot::ArmReading& right = reading->arms[Arm::right];
    CHECK((right.wrench_in_tool.force_n - expected_n).norm() < 0.1);
    CHECK(right.wrench_time_s <= reading->time_s);
    CHECK(right.wrench_time_s >= last_s);
    fresh += right.wrench_time_s > last_s ? 1 : 0;
    stale += reading->time_s - right.wrench_time_s > 3e-3 ? 1 : 0;
    last_s = right.wrench_time_s;
  }
  MESSAGE("of 300 milliseconds " << fresh << " with a new sample, " << stale << " older than 3 ms");
  CHECK(fresh > 100);  // where the machine is busy, some milliseconds are made up for at once
}

TEST_CASE(
    "a sensor that falls silent leaves the time of its last sample, by which the guard stops" *
    doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedWrist wrist({.from = 1 << 30, .bytes = [](auto& bytes) { bytes.clear(); }});
  StillArms arms;
  auto robot =
      hardware::WristRobot::open(arms, {.of = {wrist.device(), std::nullopt}}, table, mount);
  REQUIRE_MESSAGE(robot.has_value(), reason(robot));
  REQUIRE((*robot)->stand_ready(ready()).has_value());
  for (int i = 0; i < 50; ++i) REQUIRE((*robot)->read().has_value());
  wrist.spoil_from_now();
  for (int i = 0; i < 50; ++i) REQUIRE((*robot)->read().has_value());
  const auto one = (*robot)->read(), two = (*robot)->read();
  CHECK(one->arms[Arm::left].wrench_time_s == two->arms[Arm::left].wrench_time_s);
  CHECK(two->time_s - two->arms[Arm::left].wrench_time_s > safety::Ceilings{}.stale_retract_s);
  CHECK((*robot)->fault() == nullptr);
}

TEST_CASE("a long rest is no gap: what queued up is forgotten" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  for (const Kind kind : {Kind::hex_serial, Kind::ati_udp}) {
    ScriptedWrist wrist({.kind = kind});
    StillArms arms;
    auto robot =
        hardware::WristRobot::open(arms, {.of = {wrist.device(), std::nullopt}}, table, mount);
    REQUIRE_MESSAGE(robot.has_value(), reason(robot));
    REQUIRE((*robot)->stand_ready(ready()).has_value());
    REQUIRE((*robot)->read().has_value());
    (*robot)->rest();
    std::this_thread::sleep_for(400ms);
    const auto reading = (*robot)->read();
    CHECK((*robot)->sensor(Arm::left)->stream().fault() == nullptr);
    CHECK(reading->time_s - reading->arms[Arm::left].wrench_time_s < 0.1);
    CHECK((*robot)->sensor(Arm::right) == nullptr);
  }
}

TEST_CASE("the first sample after a long rest is one of now, however much the line has kept" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  constexpr int wraps = 16'000;
  ScriptedWrist wrist({.sample = [](ScriptedWrist::Sample& said) {
    said.counts[0] = static_cast<int>(said.counter % wraps);
  }});
  WristDevice device = wrist.device();
  device.zero_at_start = false;
  device.counts_per_n.setConstant(1.0);
  auto sensor = WristSensor::open(device);
  REQUIRE_MESSAGE(sensor.has_value(), reason(sensor));
  std::this_thread::sleep_for(1500ms);
  REQUIRE(sensor->begin_anew());
  const int said = static_cast<int>(std::lround(sensor->stream().in_tool().force_n.x()));
  CHECK((wrist.sent() - said + wraps) % wraps < 50);  // of 1500 that nobody heard
  const auto until = Clock::now() + 20ms;
  while (Clock::now() < until) {
    sensor->wait(until);
    (void)sensor->hear();
  }
  CHECK(sensor->stream().fault() == nullptr);
}

TEST_CASE("a zero that nobody knows, or a tool of another weight, is refused before the start" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedWrist wrist({.counts = {500, 0, 0, 0, 0, 0}});  // 10 N
  StillArms arms;
  WristDevice device = wrist.device();
  const auto refusal = [&] {
    auto robot = hardware::WristRobot::open(arms, {.of = {device, std::nullopt}}, table, mount);
    if (robot) {
      const auto stands = (*robot)->stand_ready(ready());
      return stands ? std::string("opened") : stands.error().message;
    }
    return robot.error().message;
  };
  device.zero_at_start = false;
  CHECK(refusal().find("where this wrist sensor's zero is would be guessed") != std::string::npos);
  device.calibration = hardware::WristCalibration{.mass_kg = 0.3};
  CHECK(refusal().find("weighs 0.300 kg by its calibration and 0.160 kg") != std::string::npos);
  device.calibration->mass_kg = 0.16;
  CHECK(refusal() == "opened");
  device.zero_at_start = true;
  device.calibration->offset_in_tool.force_n = {-10.0, 0.0, 0.0};
  CHECK(refusal().find("its zero would move by") != std::string::npos);
}
