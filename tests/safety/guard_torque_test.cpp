// SPDX-License-Identifier: Apache-2.0
// Torque: its size, its rate, and what is no torque.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE("a quiet contact passes for ever and its torques come out unchanged") {
  Scene scene;
  for (int i = 0; i < 2000; ++i) {
    REQUIRE(scene.tick().action == Action::pass);
    REQUIRE(scene.verdict.cause == Cause::none);
    REQUIRE_FALSE(scene.verdict.latched);
    REQUIRE(scene.verdict.allowed_nm == scene.proposal.torque_nm);
  }
}

TEST_CASE("torque is clamped in size, to the drives' limits on both sides") {
  for (const double direction : {1.0, -1.0}) {
    Scene scene;
    scene.face(Vector3::UnitX());
    scene.seen.gravity_nm.setConstant(direction * 49.5);
    scene.proposal.torque_nm.setConstant(direction * 50.0);
    CHECK(scene.tick().action == Action::pass);
    scene.proposal.torque_nm[3] = direction * 50.5;
    CHECK(scene.tick().action == Action::warn);
    CHECK(scene.verdict.cause == Cause::torque_clamped);
    CHECK_FALSE(scene.verdict.latched);
    CHECK(scene.verdict.allowed_nm == JointVector::Constant(6, direction * 50.0));
  }
}

TEST_CASE("torque is clamped in its rate: 1 Nm in a millisecond, both ways") {
  for (const double direction : {1.0, -1.0}) {
    Scene scene;
    scene.tick(10);
    const double before_nm = scene.proposal.torque_nm[4];
    scene.proposal.torque_nm[4] += direction * 30.0;
    CHECK(scene.tick().allowed_nm[4] == doctest::Approx(before_nm + direction));
    CHECK(scene.verdict.action == Action::warn);
    CHECK(scene.verdict.cause == Cause::torque_rate_clamped);
    CHECK_FALSE(scene.verdict.latched);
    CHECK(scene.tick(29).allowed_nm[4] == doctest::Approx(scene.proposal.torque_nm[4]));
    CHECK(scene.tick().action == Action::pass);
  }
}

TEST_CASE("the first torque may be gravity's, however large, and is held to the drives' limits") {
  for (const double gravity_nm : {40.0, 80.0, -80.0}) {
    Scene scene;
    scene.seen.jacobian.setZero();  // or the rest of the weight would press on somebody
    scene.seen.gravity_nm.setConstant(gravity_nm);
    scene.proposal.torque_nm.setConstant(std::clamp(gravity_nm, -50.0, 50.0));
    CHECK(scene.tick().action == Action::pass);
    CHECK(scene.verdict.allowed_nm == scene.proposal.torque_nm);
  }
}

TEST_CASE("drives that are asked for all they can give for a tenth of a second are saturated") {
  for (const double direction : {1.0, -1.0}) {
    for (const double beyond_nm : {0.0, 0.5}) {
      Scene scene;
      scene.seen.gravity_nm[3] = scene.proposal.torque_nm[3] = direction * 49.999;
      CHECK(scene.tick(300).action == Action::pass);
      scene.proposal.torque_nm[3] = direction * (50.0 + beyond_nm);
      CHECK(scene.tick(99).action == (beyond_nm > 0.0 ? Action::warn : Action::pass));
      scene.proposal.torque_nm[3] = direction * 49.999;
      CHECK(scene.tick().action == Action::pass);
      scene.proposal.torque_nm[3] = direction * (50.0 + beyond_nm);
      CHECK(scene.ticks_until_it_acts() == 99);
      CHECK(scene.verdict.action == Action::comply);
      CHECK(scene.verdict.cause == Cause::torque_saturated);
      CHECK(scene.verdict.latched);
    }
  }
  Scene scene;  // what is no number is not counted as much
  scene.seen.gravity_nm[3] = scene.proposal.torque_nm[3] = 50.0;
  scene.tick(99);
  scene.proposal.torque_nm[0] = not_a_number;
  CHECK(scene.tick().cause == Cause::torque_not_finite);
  CHECK_FALSE(scene.verdict.latched);
}

TEST_CASE("a controller may let go ten times as suddenly as it may press, in contact and leaving") {
  for (const double direction : {1.0, -1.0}) {
    for (int phase = 0; phase < 4; ++phase) {
      Scene scene;
      scene.face(Vector3::UnitX());
      scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
      scene.tick(10);
      scene.proposal.phase = static_cast<Phase>(phase);
      const double before_nm = scene.proposal.torque_nm[0];
      // The first joint moves the tool along x; to press by 25 N at once is borne.
      scene.proposal.torque_nm[0] += direction > 0.0 ? 40.0 : -5.0;
      const double step_nm = scene.tick().allowed_nm[0] - before_nm;
      const bool may_press =
          scene.proposal.phase == Phase::contact || scene.proposal.phase == Phase::retract;
      const bool lets_go = may_press && direction > 0.0;
      CHECK(step_nm == doctest::Approx(lets_go ? 10.0 : direction));
    }
  }
}

TEST_CASE("letting go is a change that points outward by nine tenths") {
  for (const double along : {0.905, 0.895}) {
    Scene scene;
    scene.face(Vector3::UnitX());
    scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
    scene.tick(10);
    const double before_nm = scene.proposal.torque_nm[0];
    scene.proposal.torque_nm[0] += 20.0 * along;
    scene.proposal.torque_nm[1] += 20.0 * std::sqrt(1.0 - along * along);
    CHECK(scene.tick().allowed_nm[0] - before_nm == doctest::Approx(along > 0.9 ? 10.0 : 1.0));
  }
}

TEST_CASE("a tool that no joint moves is not let go suddenly") {
  Scene scene;
  scene.seen.jacobian.setZero();
  scene.tick(10);
  const double before_nm = scene.proposal.torque_nm[0];
  scene.proposal.torque_nm[0] += 20.0;
  CHECK(scene.tick().allowed_nm[0] - before_nm == doctest::Approx(1.0));
}

TEST_CASE("joints that are unknown from the first tick on get no torque") {
  Scene scene;
  scene.seen.q_rad[0] = not_a_number;
  CHECK(scene.tick().action == Action::brake);
  CHECK(scene.verdict.allowed_nm == JointVector::Zero(6));
}

TEST_CASE(
    "a torque that is no number is replaced in the same tick, whole; three of them end the "
    "contact") {
  Scene scene;
  scene.tick(10);
  const JointVector before_nm = scene.proposal.torque_nm;
  for (int burst = 0; burst < 2; ++burst) {
    scene.proposal.torque_nm = before_nm;
    CHECK(scene.tick().action == Action::pass);
    scene.proposal.torque_nm[1] += 0.5;
    scene.proposal.torque_nm[4] = not_a_number;
    for (int i = 0; i < 2; ++i) {
      CHECK(scene.tick().action == Action::warn);
      CHECK(scene.verdict.cause == Cause::torque_not_finite);
      CHECK_FALSE(scene.verdict.latched);
      CHECK(scene.verdict.allowed_nm == before_nm);
    }
  }
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::torque_not_finite);
  CHECK(scene.verdict.latched);
}

TEST_CASE("a torque of other joints is a torque that is no number") {
  for (const Eigen::Index joints : {0, 5, 7}) {
    Scene scene;
    scene.tick(10);
    scene.proposal.torque_nm.setConstant(joints, 60.0);
    CHECK(scene.tick().cause == Cause::torque_not_finite);
    CHECK(scene.tick(2).action == Action::retract);
  }
}

TEST_CASE("a speed beyond all numbers does not get a torque out that is none") {
  Scene scene;
  scene.tick(10);
  scene.retract();
  const JointVector before_nm = scene.verdict.allowed_nm;
  scene.seen.tool_velocity_m_per_s = Vector3::Constant(1e308);
  scene.tick();
  CHECK(scene.verdict.allowed_nm.allFinite());
  CHECK((scene.verdict.allowed_nm - before_nm).cwiseAbs().maxCoeff() <= 10.0 + 1e-9);
}

TEST_CASE("a torque of the guard's own that is no number is the last one again") {
  Scene scene;
  scene.force_n = 0.0;
  scene.tick(10);
  scene.comply();
  const JointVector before_nm = scene.verdict.allowed_nm;
  scene.seen.tool_velocity_m_per_s = Vector3(1e308, -1e308, 1e308);
  CHECK(scene.tick().allowed_nm == before_nm);
}

TEST_CASE("a tool that no joint moves presses nobody, where nothing may be pressed at all either") {
  Guard::Options options = six_joints();
  options.limits.pressing_n = 0.0;
  for (ForceLimits& limits : options.force) limits.trip_n = 0.0;
  Scene scene(options);
  scene.force_n = scene.noise_n = scene.proposal.set_force_n = 0.0;
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.seen.jacobian.setZero();
  CHECK(scene.tick(3).action == Action::pass);
}
