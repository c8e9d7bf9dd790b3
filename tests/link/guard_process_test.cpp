// SPDX-License-Identifier: Apache-2.0
// A guard in a thread of its own, as it runs in its process.
#include "tuina/link/guard_process.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <atomic>
#include <optional>
#include <thread>

#include "tuina/control/tool_motion.hpp"
#include "tuina/robot/ready_posture.hpp"

using namespace tuina;
using namespace tuina::link;

namespace {

/// A guard in its own thread, and a robot that stands.
struct Guarded {
  explicit Guarded(const std::string& called, bool leased = false)
      : name("test-" + called + "-" + std::to_string(getpid())) {
    arming.options.leased = leased;
    REQUIRE(guard.has_value());
    process = std::thread([this] { report = keep_guard(*guard, arming, Pace::max, ends); });
  }
  ~Guarded() { over(); }
  void over() {
    wire::SensorFrame last_words = wire::to_frame(reading);
    last_words.over = 1;
    drives->write(last_words);
    if (process.joinable()) process.join();
  }
  /// What a robot that stands senses in the next millisecond, and what would hold it there.
  safety::RobotProposal sense() {
    reading.tick = ticks;
    reading.time_s = static_cast<double>(ticks) * control_period_s;
    safety::RobotProposal proposal;
    for (const Arm arm : both_arms) {
      const Transform base_from_tool = models[arm].base_from_tool(ready_rad[arm], 0.0);
      const Matrix3 turn = base_from_tool.linear();
      const Vector3 pressed_n = body_n * control::tool_normal(base_from_tool);
      const double weight_n =
          models[arm].table().tool_mass_kg * 9.81 + 1e-6 * reading.time_s + felt_n;
      reading.arms[arm] = {
          .q_rad = ready_rad[arm],
          .dq_rad_per_s = JointVector::Zero(6),
          .wrench_in_tool = {turn.transpose() * (pressed_n - Vector3(0.0, 0.0, weight_n)),
                             Vector3::Zero()},
          .wrench_time_s = reading.time_s};
      proposal.arms[arm].torque_nm = models[arm].gravity_nm(ready_rad[arm]);
      if (body_n > 0.0) {
        const auto dynamics = models[arm].evaluate(ready_rad[arm], JointVector::Zero(6), 0.0);
        proposal.arms[arm].torque_nm -= dynamics.jacobian.topRows<3>().transpose() * pressed_n;
        proposal.arms[arm].phase = safety::Phase::contact;
        proposal.arms[arm].zone = safety::Zone::muscle;
        proposal.arms[arm].set_force_n = body_n;
        proposal.arms[arm].normal_in_base = pressed_n.normalized();
      }
    }
    return proposal;
  }
  /// One millisecond, answered by the controller or not.
  safety::RobotVerdict tick(bool speaks = true) {
    const safety::RobotProposal proposal = sense();
    wire::SensorFrame frame = wire::to_frame(reading);
    frame.stands = 1;
    if (speaks) controller->write(wire::to_frame(proposal, ticks, false));
    drives->write(frame);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    const auto answer = drives->wait_for(deadline, [&]() {
      const auto said = drives->drive();
      return said && said->answers_tick == ticks ? said : std::nullopt;
    });
    REQUIRE(answer.has_value());
    ++ticks;
    return wire::from_frame(*answer);
  }

  std::string name;
  Result<Link> controller = Link::create(name, Role::controller);
  Result<Link> drives = Link::open(name, Role::drives), guard = Link::open(name, Role::guard);
  Result<Link> desk = Link::open(name, Role::operating), hand = Link::open(name, Role::hand_stop);
  Arming arming{.arm = robot::thesis_arm(), .mount = robot::mount_for(BodyPosture::sitting)};
  PerArm<robot::ArmModel> models = robot::both_models(arming.arm, arming.mount);
  PerArm<JointVector> ready_rad = robot::ready_posture(arming.arm, arming.mount);
  std::atomic<bool> ends = false;
  Result<GuardReport> report = fail(Fault::device, "did not run");
  robot::RobotReading reading;
  std::uint64_t ticks = 0;
  double felt_n = 0.0;  ///< by the wrists, in the air
  double body_n = 0.0;  ///< out of a body under both tools
  std::thread process;
};

}  // namespace

TEST_CASE("a guard in its own thread guards until the drives fall silent, and tells of silence") {
  Guarded robot("guard");
  for (std::uint64_t tick = 0; tick < 40; ++tick) {
    const safety::Verdict left = robot.tick(tick < 20).arms[Arm::left];
    CAPTURE(tick);
    CAPTURE(std::string(safety::name_of(left.cause)));
    if (tick < 22) CHECK(left.action == safety::Action::pass);
    if (tick >= 22 && tick < 29) CHECK(left.action == safety::Action::freeze);
    if (tick >= 29) CHECK(left.action == safety::Action::retract);
    if (tick >= 22) CHECK(left.cause == safety::Cause::no_proposal);
  }
  robot.over();
  REQUIRE(robot.report.has_value());
  CHECK(robot.report->ticks == 40);
  CHECK(robot.report->silent_ticks == 20);
}

TEST_CASE("a guard that finds joints or wrists amiss before its first millisecond is not armed") {
  Guarded sound("sound");
  sound.felt_n = 4.9;
  CHECK(sound.tick().arms[Arm::left].action == safety::Action::pass);
  const auto refused = [](const char* what, const auto& spoil) {
    Guarded robot("refused");
    robot.felt_n = 4.9;
    (void)robot.sense();
    spoil(robot.reading.arms[Arm::right]);
    wire::SensorFrame frame = wire::to_frame(robot.reading);
    frame.stands = 1;
    robot.drives->write(frame);
    robot.process.join();
    REQUIRE_FALSE(robot.report.has_value());
    CHECK(robot.report.error().message.find(what) != std::string::npos);
  };
  refused("a wrist sensor feels a force in the air",
          [](auto& arm) { arm.wrench_in_tool.force_n *= 2.0; });
  refused("the robot has other joints", [](auto& arm) { arm.q_rad.conservativeResize(5); });
}

TEST_CASE("a stop in a hand, or of the operator, reaches a guard in its own thread at once") {
  for (const bool by_hand : {false, true}) {
    Guarded robot("stop");
    (by_hand ? robot.hand : robot.desk)->write(wire::WatchFrame{.beat = 1});
    CHECK(robot.tick().arms[Arm::left].action == safety::Action::pass);
    (by_hand ? robot.hand : robot.desk)->write(wire::WatchFrame{.beat = 2, .stop = 1});
    for (const safety::Verdict& one : robot.tick().arms.of) {
      CHECK(one.action == safety::Action::retract);
      CHECK(one.cause == safety::Cause::asked_to);
    }
  }
}

TEST_CASE("a guard that is to end goes on until no tool has pressed for half a second") {
  Guarded robot("end");
  robot.tick();
  for (; robot.body_n < 20.0; robot.body_n += 0.5) robot.tick();  // no sensor's fault is as slow
  robot.ends = true;
  for (int i = 0; i < 40; ++i) {
    for (const safety::Verdict& one : robot.tick().arms.of) CHECK(one.latched);
  }
  for (; robot.body_n > 0.0; robot.body_n -= 0.5) robot.tick();
  for (int i = 0; i < 480; ++i) robot.tick();
  for (int i = 0; i < 25; ++i, ++robot.ticks) {  // nobody may be there to answer these
    const safety::RobotProposal proposal = robot.sense();
    robot.controller->write(wire::to_frame(proposal, robot.ticks, false));
    wire::SensorFrame frame = wire::to_frame(robot.reading);
    frame.stands = 1;
    robot.drives->write(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  robot.process.join();
  REQUIRE(robot.report.has_value());
  CHECK(robot.report->last[Arm::left].latched);
}

TEST_CASE("a guard whose controller has died goes on until the tools have left, and no longer") {
  Guarded robot("orphan");
  robot.tick();
  for (; robot.body_n < 20.0; robot.body_n += 0.5) robot.tick();
  robot.controller = fail(Fault::device, "killed");
  CHECK_FALSE(robot.drives->maker_lives());
  for (int i = 0; i < 700; ++i) robot.tick(false);
  CHECK(robot.tick(false).arms[Arm::left].action == safety::Action::retract);
  for (; robot.body_n > 0.0; robot.body_n -= 0.5) robot.tick(false);
  const std::uint64_t left_tick = robot.ticks;
  for (int i = 0; i < 480; ++i) robot.tick(false);
  for (int i = 0; i < 60; ++i, ++robot.ticks) {  // nobody may be there to answer these
    (void)robot.sense();
    wire::SensorFrame frame = wire::to_frame(robot.reading);
    frame.stands = 1;
    robot.drives->write(frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  robot.over();
  REQUIRE(robot.report.has_value());
  CHECK(robot.report->ticks <= left_tick + 510);
}

TEST_CASE("a leased robot leaves when a stop in a hand has been silent for half a second") {
  Guarded robot("lease", true);
  for (std::uint64_t tick = 1; tick <= 700; ++tick) {
    robot.desk->write(wire::WatchFrame{.beat = tick});
    if (tick <= 100) robot.hand->write(wire::WatchFrame{.beat = tick});
    const safety::Verdict left = robot.tick().arms[Arm::left];
    CAPTURE(tick);
    CHECK(left.action == (tick < 600 ? safety::Action::pass : safety::Action::retract));
    if (tick >= 600) CHECK(left.cause == safety::Cause::lease_over);
  }
}
