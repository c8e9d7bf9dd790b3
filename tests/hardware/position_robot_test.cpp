// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/position_robot.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <string>

#include "tests/allocation.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;
using hardware::PositionRobot;

namespace {

/// Arms in the air that are where they were sent some milliseconds ago. The script says what goes
/// wrong from a millisecond on.
class PlacedDrives final : public robot::PositionDrives {
 public:
  int lag_ticks = 10;
  int stuck_from = 1 << 30;  ///< the left arm goes no farther
  int wrist_silent_from = 1 << 30, wrist_nan_from = 1 << 30;
  Vector3 force_in_tool_n = Vector3::Zero();
  bool tells_torques = false;
  PerArm<JointVector> torque_nm;
  robot::PlaceCommand last;
  int followed = 0, stood = 0;

  explicit PlacedDrives(const JointVector& q_rad) {
    last.q_rad = {{q_rad, q_rad}};
    for (int i = 0; i < 300; ++i) sent_.push_back(last);
    now_ = last;
  }
  Result<void> stand_ready(const robot::ReadyPose&) override {
    ++stood;
    return {};
  }
  std::optional<robot::RobotReading> read() noexcept override {
    reading_.tick = static_cast<std::uint64_t>(++ms_);
    reading_.time_s = 1e-3 * ms_;
    // A ring, so that the test may count what the robot takes from the heap.
    sent_[static_cast<std::size_t>(ms_) % sent_.size()] = last;
    now_ = sent_[static_cast<std::size_t>(ms_ + 300 - lag_ticks) % sent_.size()];
    for (const Arm arm : both_arms) {
      robot::ArmReading& seen = reading_.arms[arm];
      if (arm == Arm::right || ms_ < stuck_from) seen.q_rad = now_.q_rad[arm];
      seen.dq_rad_per_s = JointVector::Zero(seen.q_rad.size());
      seen.wrench_in_tool.force_n = force_in_tool_n;
      if (ms_ >= wrist_nan_from)
        seen.wrench_in_tool.force_n.x() = std::numeric_limits<double>::quiet_NaN();
      if (ms_ < wrist_silent_from) seen.wrench_time_s = reading_.time_s - 1e-3;
    }
    return reading_;
  }
  const PerArm<JointVector>* driven_nm() const noexcept override {
    return tells_torques ? &torque_nm : nullptr;
  }
  void follow(const robot::PlaceCommand& command) noexcept override {
    last = command;
    ++followed;
  }
  const char* fault() const noexcept override { return nullptr; }

 private:
  std::deque<robot::PlaceCommand> sent_;
  robot::PlaceCommand now_;
  robot::RobotReading reading_;
  int ms_ = 0;
};

struct Stage {
  PerArm<robot::ArmModel> models;
  JointVector q_rad;
  PlacedDrives drives;
  Vector3 inward;  ///< the way the left tool presses
  PositionRobot robot;
  explicit Stage(const robot::RobotPlacement& placed)
      : models(robot::both_models(placed.arm, placed.mount)),
        q_rad(placed.mount.ready_near_rad),
        drives(q_rad),
        inward(models[Arm::left].base_from_tool(q_rad, 0.0).linear().col(0)),
        robot(drives, models, {.lag_s = 10e-3}) {}
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Torques against the weight, and a force at the left tool.
  robot::RobotCommand command(const robot::RobotReading& reading, const Vector3& force_n) const {
    robot::RobotCommand told;
    for (const Arm arm : both_arms) {
      const auto dynamics = models[arm].evaluate(reading.arms[arm].q_rad,
                                                 reading.arms[arm].dq_rad_per_s, reading.rail_m);
      told.torque_nm[arm] = dynamics.gravity_nm + dynamics.coriolis_nm;
      if (arm == Arm::left)
        told.torque_nm[arm] += dynamics.jacobian.topRows<3>().transpose() * force_n;
    }
    return told;
  }
  Vector3 tool_sent_in_base() const {
    return models[Arm::left].base_from_tool(drives.last.q_rad[Arm::left], 0.0).translation();
  }
  /// The wrist of an arm that hangs free carries its tool.
  void weigh() {
    const Matrix3 turn = models[Arm::left].base_from_tool(q_rad, 0.0).linear();
    drives.force_in_tool_n =
        turn.transpose() *
        Vector3(0, 0, -models[Arm::left].table().tool_mass_kg * gravity_m_per_s2);
  }
  void live(int ms, const Vector3& force_n) {
    for (int i = 0; i < ms; ++i) {
      const auto reading = robot.read();
      REQUIRE(reading.has_value());
      robot.apply(command(*reading, force_n));
    }
  }
};

robot::RobotPlacement placed_ur() {
  const auto ur = robot::load_robot("ur");
  REQUIRE(ur.has_value());
  return robot::place_robot(*ur, BodyPosture::sitting);
}

}  // namespace

TEST_CASE("arms that take places move as torques would move them, and the readings are not late") {
  Stage stage(placed_ur());
  stage.weigh();
  const Vector3 before = stage.tool_sent_in_base();
  stage.live(100, 2.0 * stage.inward);
  CHECK((stage.tool_sent_in_base() - before).dot(stage.inward) > 0.5e-3);
  const auto reading = stage.robot.read();
  REQUIRE(reading.has_value());
  const JointVector& q_rad = reading->arms[Arm::left].q_rad;
  const JointVector& sent_rad = stage.drives.last.q_rad[Arm::left];
  CHECK((q_rad - sent_rad).norm() < 1e-9);  // and not where the arm was sent 10 ms ago
  CHECK(reading->arms[Arm::left].dq_rad_per_s.norm() > 0.0);
  CHECK(stage.robot.fault() == nullptr);
}

TEST_CASE("arms of which nobody tells torques do not stand ready unless that is allowed") {
  Stage stage(placed_ur());
  const auto refused = stage.robot.stand_ready({});
  REQUIRE_FALSE(refused.has_value());
  CHECK(refused.error().fault == Fault::config);
  CHECK(refused.error().message.find("nothing but the wrist sensor bounds") != std::string::npos);
  CHECK(stage.drives.stood == 0);
  PositionRobot allowed(stage.drives, stage.models, {.bounded_by_wrist_alone = true});
  CHECK(allowed.stand_ready({}).has_value());
  stage.drives.tells_torques = true;
  CHECK(stage.robot.stand_ready({}).has_value());
  CHECK(stage.drives.stood == 2);
}

TEST_CASE("what lasts of a wrong place is in the readings") {
  Stage stage(placed_ur());
  stage.weigh();
  stage.drives.stuck_from = 50;
  stage.live(50, Vector3::Zero());
  const JointVector stood_rad = stage.drives.last.q_rad[Arm::left];
  stage.live(50, 0.1 * stage.inward);
  stage.live(1000, Vector3::Zero());
  const auto reading = stage.robot.read();
  REQUIRE(stage.robot.fault() == nullptr);
  const JointVector& sent_rad = stage.drives.last.q_rad[Arm::left];
  const double told_rad = (reading->arms[Arm::left].q_rad - stood_rad).norm();
  CHECK(told_rad < 0.7 * (sent_rad - stood_rad).norm());
}

TEST_CASE("an arm that is not where it was sent is a fault, and is sent nowhere more") {
  Stage stage(placed_ur());
  stage.weigh();
  stage.drives.stuck_from = 50;
  stage.live(1000, 5.0 * stage.inward);
  REQUIRE(stage.robot.fault() != nullptr);
  CHECK(std::string(stage.robot.fault()) == "the left arm is not where it was sent");
  const int followed = stage.drives.followed;
  CHECK(followed < 900);
  stage.live(10, 5.0 * stage.inward);
  CHECK(stage.drives.followed == followed);
}

TEST_CASE("a wrist sensor that is silent or says no number lets no tool go on into the body") {
  for (const bool silent : {true, false}) {
    Stage stage(placed_ur());
    stage.weigh();
    stage.live(20, Vector3::Zero());
    // The body pushes back with 10 N, and 10 N are pressed.
    const Matrix3 turn = stage.models[Arm::left].base_from_tool(stage.q_rad, 0.0).linear();
    stage.drives.force_in_tool_n += turn.transpose() * Vector3(-10.0 * stage.inward);
    stage.live(20, 10.0 * stage.inward);
    (silent ? stage.drives.wrist_silent_from : stage.drives.wrist_nan_from) = 41;
    stage.live(5, 10.0 * stage.inward);
    const Vector3 before = stage.tool_sent_in_base();
    stage.live(200, 30.0 * stage.inward);
    CHECK((stage.tool_sent_in_base() - before).dot(stage.inward) < 0.1e-3);
    stage.live(100, -5.0 * stage.inward);
    CHECK((stage.tool_sent_in_base() - before).dot(stage.inward) < -0.5e-3);
  }
}

TEST_CASE("drives that press harder than the wrist feels are believed, until it feels them again") {
  Stage stage(placed_ur());
  stage.weigh();
  const auto dynamics =
      stage.models[Arm::left].evaluate(stage.q_rad, JointVector::Zero(stage.q_rad.size()), 0.0);
  const JointVector lever = dynamics.jacobian.topRows<3>().transpose() * stage.inward;
  const Matrix3 turn = dynamics.base_from_tool.linear();
  const Vector3 weight_in_tool_n = stage.drives.force_in_tool_n;
  const auto told_n = [&](double pressed_n, double felt_n) {
    for (const Arm arm : both_arms) stage.drives.torque_nm[arm] = dynamics.gravity_nm;
    stage.drives.torque_nm[Arm::left] += pressed_n * lever;
    stage.drives.force_in_tool_n =
        weight_in_tool_n - turn.transpose() * Vector3(felt_n * stage.inward);
    const auto reading = stage.robot.read();
    REQUIRE(reading.has_value());
    CHECK(reading->arms[Arm::right].wrench_in_tool.force_n == stage.drives.force_in_tool_n);
    return weight_in_tool_n.x() - reading->arms[Arm::left].wrench_in_tool.force_n.x();
  };
  CHECK(told_n(200.0, 10.0) == doctest::Approx(10.0));  // nobody tells what the drives do
  stage.drives.tells_torques = true;
  // Friction of the UR5e's table bears some of it; how much is found by pressing very hard.
  const double friction_n = 1000.0 - told_n(1000.0, 10.0);
  CHECK(friction_n > 1.0);
  CHECK(friction_n < 120.0);
  CHECK(told_n(friction_n + 10.0, 10.0) == doctest::Approx(10.0));
  CHECK(told_n(friction_n + 29.0, 10.0) == doctest::Approx(10.0));
  CHECK(told_n(friction_n + 31.0, 10.0) == doctest::Approx(31.0));
  CHECK(told_n(friction_n + 16.0, 10.0) == doctest::Approx(16.0));
  CHECK(told_n(friction_n + 14.0, 10.0) == doctest::Approx(10.0));
  CHECK(told_n(friction_n + 29.0, 10.0) == doctest::Approx(10.0));
  CHECK(told_n(friction_n - 60.0, 10.0) == doctest::Approx(10.0));    // this wrist feels more
  CHECK(told_n(friction_n + 40.0, -20.0) == doctest::Approx(-20.0));  // a reversed one is seen
}

TEST_CASE("nobody follows a host that is silent, nor moves an arm that is braked") {
  Stage stage(placed_ur());
  stage.weigh();
  stage.live(100, 2.0 * stage.inward);
  for (int ms = 0; ms < 5; ++ms) REQUIRE(stage.robot.read().has_value());
  const auto silent = stage.robot.read();
  CHECK(silent->arms[Arm::left].dq_rad_per_s.norm() < 1e-3);
  stage.live(50, 2.0 * stage.inward);
  const JointVector there_rad = stage.drives.last.q_rad[Arm::left];
  for (int ms = 0; ms < 50; ++ms) {
    auto told = stage.command(*stage.robot.read(), 20.0 * stage.inward);
    told.brake = {{true, true}};
    stage.robot.apply(told);
  }
  CHECK(stage.drives.last.q_rad[Arm::left] == there_rad);
}

TEST_CASE("a millisecond of arms that take places takes no memory from the heap") {
  Stage stage(placed_ur());
  stage.live(3, Vector3::Zero());
  const std::size_t before = test::allocations();
  stage.live(20, 1.0 * stage.inward);
  CHECK(test::allocations() == before);
}
