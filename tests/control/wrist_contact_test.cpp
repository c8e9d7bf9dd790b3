// SPDX-License-Identifier: Apache-2.0
// A press whose force arrives by a wrist sensor of its own, over UDP, in the simulated robot's
// time; judged on the true force.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "apps/simulated/devices/emulated_wrist.hpp"
#include "tests/reason.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/wrist_robot.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;
using namespace tuina::app;
using test::reason;

namespace {

/// A robot that tells what its left arm feels to a sensor, and nobody else.
class FeelingArms final : public robot::Robot {
 public:
  FeelingArms(robot::Robot& arms, EmulatedWrist& wrist) : arms_(arms), wrist_(wrist) {}
  Result<void> stand_ready(const robot::ReadyPose& pose) override {
    return arms_.stand_ready(pose);
  }
  std::optional<robot::RobotReading> read() noexcept override {
    auto reading = arms_.read();
    if (!reading) return reading;
    robot::ArmReading& left = reading->arms[Arm::left];
    wrist_.feel(reading->time_s, left.wrench_in_tool);
    left.wrench_in_tool = {};
    left.wrench_time_s = 0.0;
    return reading;
  }
  void apply(const robot::RobotCommand& command) noexcept override {
    wrist_.stand(false);
    arms_.apply(command);
  }
  const char* fault() const noexcept override { return arms_.fault(); }

 private:
  robot::Robot& arms_;
  EmulatedWrist& wrist_;
};

std::unique_ptr<EmulatedWrist> wrist_with(WristFailure failure) {
  static int next = 30'000 + static_cast<int>(getpid() % 20'000);
  for (;;) {
    const std::string address = fmt::format("127.0.0.1:{}", next++);
    auto wrist = EmulatedWrist::listen(*hardware::parse_udp_address(address), address, failure);
    if (wrist) return std::move(*wrist);
  }
}

struct Felt {
  ContactOutcome press;
  std::string fault;  ///< of the sensor
};

/// The zero of the emulated sensor, turned into the tool's axes, about the tool's origin.
Wrench zero_in_tool(const Vector3& sensor_in_tool_m) {
  const Vector3 force_n(3.0, 2.0, 1.5);
  return {.force_n = force_n,
          .torque_nm = Vector3(0.01, 0.02, 0.05) + sensor_in_tool_m.cross(force_n)};
}

Felt press_feeling(WristFailure failure, double tool_weight_error = 0.0) {
  const auto model = robot::load_robot("thesis");
  const robot::RobotPlacement placed = robot::place_robot(*model, BodyPosture::sitting);
  const auto wrist = wrist_with(failure);
  auto devices = hardware::parse_device_file(wrist->section(Arm::left), "device.toml");
  REQUIRE_MESSAGE(devices.has_value(), reason(devices));
  hardware::WristDevice& device = *devices->wrists[Arm::left];
  device.zero_at_start = false;
  device.calibration =
      hardware::WristCalibration{.mass_kg = placed.arm.tool_mass_kg * (1.0 + tool_weight_error),
                                 .offset_in_tool = zero_in_tool(device.sensor_in_tool_m)};
  std::unique_ptr<FeelingArms> arms;
  std::unique_ptr<hardware::WristRobot> robot;
  const auto joined = [&](robot::Robot& plant) -> robot::Robot& {
    arms = std::make_unique<FeelingArms>(plant, *wrist);
    auto opened = hardware::WristRobot::open(*arms, devices->wrists, placed.arm, placed.mount,
                                             hardware::WristRobot::Clock::arms);
    REQUIRE_MESSAGE(opened.has_value(), reason(opened));
    robot = std::move(*opened);
    return *robot;
  };
  auto outcome = run_contact({.force_n = 20.0,
                              .duration_s = 2.0,
                              .tool_weight_error = tool_weight_error,
                              .seen_as = joined});
  REQUIRE(outcome.has_value());
  const char* fault = robot->sensor(Arm::left)->stream().fault();
  return {std::move(*outcome), fault != nullptr ? fault : ""};
}

}  // namespace

TEST_CASE("a press that is felt by a wrist sensor over UDP is as exact as one by the arm's own") {
  const auto own = run_contact({.force_n = 20.0, .duration_s = 2.0});
  REQUIRE(own.has_value());
  const Felt felt = press_feeling({});
  CHECK(felt.press.stops.empty());
  CHECK_MESSAGE(felt.fault.empty(), felt.fault);
  CHECK(felt.press.estimate.converged == own->estimate.converged);
  MESSAGE("force error, N RMS: arm's own " << own->force.rmse_n << ", wrist sensor "
                                           << felt.press.force.rmse_n);
  CHECK(std::abs(felt.press.force.rmse_n - own->force.rmse_n) < 0.1);
}

TEST_CASE(
    "a tool that its calibration knows to be 40 g heavier than the table presses as exactly") {
  const Felt heavier = press_feeling({}, 0.25);
  CHECK(heavier.press.stops.empty());
  MESSAGE("force error, N RMS: " << heavier.press.force.rmse_n);
  CHECK(heavier.press.force.rmse_n < 0.5);
}

TEST_CASE("a wrist sensor that is silent, stuck or off in a press ends in the guard's retreat") {
  using Kind = WristFailure::Kind;
  struct Case {
    Kind kind;
    const char *cause, *fault;
    double within_s;
  };
  const auto own = run_contact({.force_n = 20.0, .duration_s = 2.0});
  REQUIRE(own.has_value());
  const auto begins = std::find_if(own->trace.begin(), own->trace.end(),
                                   [](const ContactSample& at) { return at.target_n > 0.0; });
  REQUIRE(begins != own->trace.end());
  const double fails_s = begins->time_s + 1.0;
  for (const Case& one : {Case{Kind::silent, "force sensor stale", "lost 10 samples", 0.006},
                          Case{Kind::stuck, "force sensor stuck", "", 0.025},
                          Case{Kind::off, "force sensor stale", "", 0.006}}) {
    INFO(std::string(one.cause));
    const Felt felt = press_feeling({.kind = one.kind, .at_s = fails_s});
    REQUIRE(felt.press.stops.size() == 1);
    CHECK(felt.press.stops[0].cause == std::string(one.cause));
    const double after_s = felt.press.stops[0].time_s - fails_s;
    CHECK(after_s > 0.0);
    CHECK(after_s <= one.within_s);
    CHECK(felt.fault.find(one.fault) != std::string::npos);
    CHECK(felt.press.highest_n > 10.0);                  // the tool was pressing when it failed
    CHECK(felt.press.highest_n < 22.0);                  // 20 N were asked for
    CHECK(felt.press.trace.back().true_force_n == 0.0);  // the tool is off the skin
    MESSAGE(std::string(one.cause)
            << " after " << 1e3 * after_s << " ms, highest " << felt.press.highest_n << " N");
  }
}
