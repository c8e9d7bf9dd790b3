// SPDX-License-Identifier: Apache-2.0
// The guard of a whole robot: raw readings in, what the drives do out.
#include "tuina/safety/robot_guard.hpp"

#include "tests/safety/scene.hpp"
#include "tests/safety/standing_robot.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE("what is well passes to the robot as it is proposed") {
  StandingRobot robot;
  robot.press(Arm::left, 20.0);
  robot.tick(20);  // until the torques have risen to that
  for (int ms = 0; ms < 300; ++ms) {
    robot.tick();
    for (const Arm arm : both_arms) {
      REQUIRE(robot.action(arm) == Action::pass);
      REQUIRE(robot.verdict.command.torque_nm[arm] == robot.proposal.arms[arm].torque_nm);
      REQUIRE_FALSE(robot.verdict.command.brake[arm]);
    }
  }
  CHECK(robot.verdict.command.rail_m == 0.1);
  CHECK(robot.guard.arm_distance_m() == doctest::Approx(0.3));
}

TEST_CASE("the first torques are within one step of the weight of the arms, whoever tells it") {
  StandingRobot wild;
  wild.reading.tick = 1;
  for (const Arm arm : both_arms) wild.proposal.arms[arm].torque_nm.setConstant(6, -1e9);
  wild.verdict = wild.guard.check(wild.reading, wild.proposal);
  for (const Arm arm : both_arms) {
    const JointVector gravity_nm = wild.held_nm(arm);
    CHECK((wild.verdict.command.torque_nm[arm] - gravity_nm).cwiseAbs().maxCoeff() <= 10.0 + 1e-9);
  }
}

TEST_CASE("an arm whose joints are no numbers is braked, and stops the other where it moves") {
  for (const Arm lost : both_arms) {
    const Arm other = tuina::other(lost);
    for (const bool presses : {false, true}) {
      StandingRobot robot;
      if (presses) robot.press(other, 20.0);
      robot.tick(20);
      robot.reading.arms[lost].q_rad[3] = not_a_number;
      if (presses && lost == Arm::left) robot.reading.arms[lost].q_rad.setZero(5);
      robot.tick();
      CHECK(robot.action(lost) == Action::brake);
      CHECK(robot.cause(lost) == Cause::state_not_finite);
      CHECK(robot.verdict.command.brake[lost]);
      CHECK_FALSE(robot.verdict.command.brake[other]);
      CHECK((robot.verdict.command.torque_nm[lost] - robot.held_nm(lost)).norm() < 1e-9);
      CHECK(robot.action(other) == (presses ? Action::retract : Action::pass));
      if (presses) CHECK(robot.cause(other) == Cause::state_not_finite);
      // An arm that stood may not begin to move either.
      robot.reading.arms[other].dq_rad_per_s.setConstant(0.02);
      robot.tick();
      CHECK(robot.action(other) == (presses ? Action::retract : Action::freeze));
      robot.reading.arms[lost].q_rad.setZero(6);
      robot.tick(10);
      CHECK(robot.verdict.command.brake[lost]);
    }
  }
}

TEST_CASE("an arm that nobody could place from the start is held by its brakes, without torque") {
  for (const bool too_few : {false, true}) {
    StandingRobot robot;
    if (too_few) robot.reading.arms[Arm::left].q_rad.setZero(5);
    if (!too_few) robot.reading.arms[Arm::left].q_rad[0] = not_a_number;
    robot.tick();
    CHECK(robot.verdict.command.brake[Arm::left]);
    CHECK(robot.verdict.command.torque_nm[Arm::left] == JointVector::Zero(6));
  }
}

TEST_CASE("a wrist that says NaN ends the contact after 5 ms; spikes do when there are five") {
  StandingRobot robot;
  robot.press(Arm::left, 20.0);
  robot.tick(100);
  robot.wild_n.x() = not_a_number;
  CHECK(robot.tick(4).arms[Arm::left].action == Action::freeze);
  CHECK(robot.tick(2).arms[Arm::left].action == Action::retract);
  CHECK(robot.cause(Arm::left) == Cause::force_stale);
  StandingRobot spiky;
  spiky.press(Arm::left, 20.0);
  int spikes = 0;
  for (; spikes < 100 && spiky.action(Arm::left) < Action::freeze; ++spikes) {
    spiky.wild_n.x() = 0.0;
    spiky.tick(9);
    spiky.wild_n.x() = -400.0;
    spiky.tick();
  }
  CHECK(spikes == 5);
  CHECK(spiky.cause(Arm::left) == Cause::force_spikes);
}

TEST_CASE("the base stands: it is told where it stood, and when it moves both arms leave") {
  StandingRobot robot;
  robot.tick();
  robot.proposal.rail_m = 0.100995;
  CHECK(robot.tick().command.rail_m == 0.100995);
  for (const double away_m : {0.101005, 0.098995, 0.3, not_a_number}) {
    robot.proposal.rail_m = away_m;
    CHECK(robot.tick().command.rail_m == 0.1);
  }
  robot.reading.rail_m = 0.10498;
  CHECK(robot.tick().arms[Arm::left].action == Action::pass);
  for (const double moved_m : {0.10502, 0.09498}) {
    StandingRobot pushed;
    pushed.tick();
    pushed.reading.rail_m = moved_m;
    pushed.tick();
    for (const Arm arm : both_arms) {
      CHECK(pushed.action(arm) == Action::retract);
      CHECK(pushed.cause(arm) == Cause::rail_moved);
      CHECK(pushed.verdict.arms[arm].latched);
    }
  }
}

TEST_CASE(
    "a base whose place is no number at first is told what is proposed, and both are braked") {
  StandingRobot robot;
  robot.reading.rail_m = not_a_number;
  CHECK(robot.tick().command.rail_m == 0.1);
  for (const Arm arm : both_arms) CHECK(robot.verdict.command.brake[arm]);
}

TEST_CASE("of arms that come too near those that move are stopped; on skin they leave it") {
  const auto met = [](double left_rad_per_s, Phase left, Phase right) {
    StandingRobot robot({}, 0.12);
    robot.proposal.arms[Arm::left].phase = left;
    robot.proposal.arms[Arm::right].phase = right;
    robot.reading.arms[Arm::left].dq_rad_per_s[0] = left_rad_per_s;
    robot.tick();
    for (const Arm arm : both_arms)
      if (robot.action(arm) != Action::pass) CHECK(robot.cause(arm) == Cause::arms_too_close);
    return std::array{robot.action(Arm::left), robot.action(Arm::right)};
  };
  using Both = std::array<Action, 2>;
  CHECK(met(0.0, Phase::free, Phase::free) == Both{Action::freeze, Action::freeze});
  CHECK(met(0.05, Phase::free, Phase::free) == Both{Action::freeze, Action::pass});
  CHECK(met(0.0, Phase::free, Phase::contact) == Both{Action::pass, Action::retract});
  CHECK(met(0.0, Phase::approach, Phase::free) == Both{Action::retract, Action::pass});
  CHECK(met(0.0, Phase::retract, Phase::free) == Both{Action::freeze, Action::pass});
  CHECK(met(0.05, Phase::contact, Phase::contact) == Both{Action::retract, Action::retract});
}

TEST_CASE("an arm moves when its tool does by 5 mm/s") {
  for (const double m_per_s : {4.99e-3, 5.01e-3}) {
    StandingRobot robot({}, 0.12);
    robot.proposal.arms[Arm::right].phase = Phase::retract;
    const auto dynamics =
        robot.models[Arm::left].evaluate(JointVector::Zero(6), JointVector::Zero(6), 0.0);
    const double lever_m = dynamics.jacobian.topRows<3>().col(0).norm();
    robot.reading.arms[Arm::left].dq_rad_per_s[0] = m_per_s / lever_m;
    robot.tick();
    CHECK(robot.action(Arm::left) == (m_per_s > 5e-3 ? Action::freeze : Action::pass));
  }
}

TEST_CASE("too near the couch is another cause than too near each other") {
  robot::Obstacle couch{.edges_m = {2.0, 2.0, 0.1}};
  couch.base_from_box.translation().z() = -0.3 - 0.05 - 0.07;
  StandingRobot robot({.obstacles = {couch}});
  robot.press(Arm::left, 0.0);
  robot.tick();
  CHECK(robot.action(Arm::left) == Action::retract);
  CHECK(robot.cause(Arm::left) == Cause::surroundings_too_close);
  CHECK(robot.action(Arm::right) == Action::pass);
}

TEST_CASE("a stop makes both arms leave, whatever they do, and tells its cause") {
  StandingRobot robot;
  robot.press(Arm::left, 20.0);
  robot.tick(10);
  robot.guard.stop(Cause::person_moved);
  robot.tick(50);
  for (const Arm arm : both_arms) {
    CHECK(robot.action(arm) == Action::retract);
    CHECK(robot.cause(arm) == Cause::person_moved);
    CHECK(robot.verdict.arms[arm].latched);
  }
}

TEST_CASE("a lower set force of a massage lowers the trips of all zones for both arms") {
  for (const Arm arm : both_arms) {
    for (const double force_n : {14.9, 15.1}) {
      StandingRobot robot({.max_set_force_n = 5.0});
      robot.press(arm, 5.0, Zone::bony);
      robot.felt_n[arm] = -force_n * Vector3::UnitX();
      robot.tick(3);
      CHECK((robot.cause(arm) == Cause::force_over_trip) == (force_n > 15.0));
    }
    StandingRobot robot({.max_set_force_n = 5.0});
    robot.press(arm, 5.1);
    CHECK(robot.tick().arms[arm].cause == Cause::set_force_too_high);
  }
}

TEST_CASE("a bench is for who says so") {
  for (const bool bench : {false, true}) {
    StandingRobot robot({.bench = bench});
    robot.press(Arm::right, 20.0, Zone::bench);
    robot.tick(10);
    CHECK(robot.action(Arm::right) == (bench ? Action::pass : Action::retract));
  }
}

namespace {

/// Milliseconds after which the guard stops an arm that stands still while it wants 25 Nm more than
/// stand still, and that says it moves by the torques sent so many commands ago.
int blamed_after_ms(int command_age) {
  StandingRobot robot;
  for (robot::ArmReading& arm : robot.reading.arms.of) arm.command_age = command_age;
  robot.tick(30);
  CHECK(robot.action(Arm::left) == Action::pass);
  int ms = 0;
  for (; ms < 200 && robot.action(Arm::left) < Action::freeze; ++ms) {
    robot.reading.tick += 1;
    robot.reading.time_s += 1e-3;
    for (const Arm arm : both_arms) {
      robot.reading.arms[arm].wrench_time_s = robot.reading.time_s;
      robot.reading.arms[arm].wrench_in_tool.torque_nm.x() = 1e-9 * ms;
      robot.proposal.arms[arm].torque_nm = robot.held_nm(arm);
    }
    robot.proposal.arms[Arm::left].torque_nm[2] += 25.0;
    robot.verdict = robot.guard.check(robot.reading, robot.proposal);
  }
  CHECK(robot.cause(Arm::left) == Cause::drive_amiss);
  CHECK(robot.action(Arm::right) == Action::pass);
  return ms;
}

}  // namespace

TEST_CASE("torques that do not do what they should are found with the torques that were allowed") {
  const int ms = blamed_after_ms(0);
  CHECK(ms > 9);   // 1 Nm in a millisecond, of which the drive may be off by 9
  CHECK(ms < 30);  // and gears that have rung from these
}

TEST_CASE("motion is held against the torques that moved it, up to 15 commands ago") {
  const int at_once = blamed_after_ms(0);
  for (const int age : {1, 2, 5, 14, 15}) CHECK(blamed_after_ms(age) == at_once + age);
  for (const int unknown : {16, 1000, -1, -100}) CHECK(blamed_after_ms(unknown) == at_once + 15);
}

TEST_CASE("the base is where it is read to be, not where a controller says, from the first") {
  StandingRobot robot;
  robot.proposal.rail_m = 0.2;
  CHECK(robot.tick().command.rail_m == 0.1);
  CHECK(RobotProposal{}.rail_m == 0.0);
  CHECK_FALSE(RobotGuard::Options{}.bench);
  CHECK_FALSE(RobotGuard::Options{}.leased);
}

TEST_CASE("the guard of each arm knows where its joints end") {
  constexpr Eigen::Index joint = 5;
  constexpr double way_rad = 0.02;
  // Torque on a joint of a stopped arm that goes on towards its end, so far off.
  const auto moved_nm = [](double side, double off_rad) {
    StandingRobot robot;
    const robot::Link& link = robot.models[Arm::right].table().links[joint];
    robot::ArmReading& right = robot.reading.arms[Arm::right];
    right.q_rad[joint] = side > 0.0 ? link.max_rad - off_rad : link.min_rad + off_rad;
    robot.tick(5);
    robot.guard.stop(Cause::asked_to);
    robot.tick(20);
    REQUIRE(robot.action(Arm::right) == Action::retract);
    right.dq_rad_per_s[joint] = side * 0.1;
    for (int ms = 0; ms < 200; ++ms) {
      right.q_rad[joint] += side * way_rad / 200;
      robot.tick();
    }
    right.dq_rad_per_s.setZero();
    robot.tick(10);
    return robot.verdict.command.torque_nm[Arm::right][joint];
  };
  for (const double side : {1.0, -1.0}) {
    const double near_nm = moved_nm(side, 0.15), far_nm = moved_nm(side, 0.15 + way_rad);
    CHECK(near_nm - far_nm == doctest::Approx(-side * 30.0 * way_rad).epsilon(0.2));
  }
}
