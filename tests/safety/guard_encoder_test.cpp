// SPDX-License-Identifier: Apache-2.0
// Joints that are not where, or not as fast, as they are told.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE("an encoder may turn by 5 mrad in each millisecond that went by, either way") {
  const auto turned = [](int missed, double by_rad) {
    Scene scene;
    scene.seen.q_rad[2] = 0.0;
    scene.tick(10);
    scene.miss(missed);
    scene.seen.q_rad[2] = by_rad;
    return scene.tick();
  };
  for (const int missed : {0, 1, 2, 9}) {
    for (const double direction : {1.0, -1.0}) {
      const double limit_rad = 5e-3 * (missed + 1);
      const Verdict still = turned(missed, direction * limit_rad);
      CHECK(still.cause == (missed == 0 ? Cause::none : Cause::late_tick));
      const Verdict jumped = turned(missed, direction * (limit_rad + 1e-5));
      CHECK(jumped.latched);
      CHECK(jumped.action == Action::comply);
      CHECK(jumped.cause == Cause::encoder_jump);
    }
  }
}

TEST_CASE("an arm that moved while nothing answered for 11 ms or more knows where it is") {
  for (const int missed : {10, 50}) {
    Scene scene;
    scene.tick(10);
    scene.miss(missed);
    scene.seen.q_rad.array() += 0.3;
    scene.seen.dq_rad_per_s.setConstant(0.1);
    CHECK(scene.tick().action == Action::retract);
    scene.tick(10);
    CHECK(scene.verdict.cause == Cause::late_tick);
    CHECK(scene.outward_n() > 75.0);
    scene.seen.q_rad[2] += 11e-3;  // it is judged again from there
    scene.tick(10);
    CHECK(scene.outward_n() < 41.0);
  }
}

TEST_CASE("a shoulder at 2 rad/s, two ticks missed, has not jumped") {
  Scene scene;
  scene.proposal.phase = Phase::free;
  scene.seen.dq_rad_per_s[1] = 2.0;
  scene.tick(10);
  scene.miss(2);
  CHECK(scene.tick().action == Action::warn);
  CHECK(scene.tick(50).action == Action::pass);
  CHECK_FALSE(scene.verdict.latched);
}

TEST_CASE("an arm whose encoders do not stand at zero when it begins has not jumped") {
  Scene scene;
  scene.seen.q_rad.setConstant(2.0);
  CHECK(scene.tick(5).action == Action::pass);
}

TEST_CASE("joints that turn without a speed, or have one and do not turn, are not believed") {
  // What turns in a tick and is not told adds up, and fades by a fiftieth in each.
  const auto turning = [](double told_rad_per_s, double true_rad_per_s, int limit) {
    Scene scene;
    scene.proposal.phase = Phase::free;
    scene.tick(10);
    scene.seen.dq_rad_per_s[3] = told_rad_per_s;
    int ticks = 0;
    for (; ticks < limit && scene.verdict.action < Action::comply; ++ticks) {
      scene.seen.q_rad[3] += 1e-3 * (true_rad_per_s - told_rad_per_s);
      scene.tick();
    }
    if (ticks < limit) CHECK(scene.verdict.cause == Cause::encoder_jump);
    return ticks;
  };
  CHECK(turning(0.0, 4.9, 100) == 3);
  CHECK(turning(0.0, -4.9, 100) == 3);
  CHECK(turning(2.0, 0.0, 100) == 6);  // a frozen encoder
  CHECK(turning(0.0, 0.5, 100) == 26);
  CHECK(turning(0.0, 0.25, 200) == 80);
  CHECK(turning(0.0, 0.199, 2000) == 2000);
  CHECK(turning(1.0, 0.8, 2000) > 300);
}

TEST_CASE("an elbow that swings makes the arm comply, however still the tool is; a hand may turn") {
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    Scene scene;
    scene.seen.dq_rad_per_s[joint] = -3.0;
    CHECK(scene.tick(20).action == Action::pass);
    scene.seen.dq_rad_per_s[joint] = -3.01;
    CHECK(scene.tick(2).action == Action::pass);
    scene.seen.dq_rad_per_s[joint] = 0.0;
    scene.proposal.torque_nm[4] += 1e-9;  // the controller is alive
    CHECK(scene.tick().action == Action::pass);
    scene.seen.dq_rad_per_s[joint] = -3.01;
    CHECK(scene.ticks_until_it_acts(20) == (joint < 4 ? 2 : 20));
    if (joint < 4) CHECK(scene.verdict.cause == Cause::joint_too_fast);
    if (joint < 4) CHECK(scene.verdict.action == Action::comply);
  }
  Guard::Options three;
  three.torque_limit_nm = JointVector::Constant(3, 50.0);
  Scene scene(three);
  for (JointVector* of_joints : {&scene.seen.q_rad, &scene.seen.dq_rad_per_s,
                                 &scene.seen.gravity_nm, &scene.proposal.torque_nm})
    of_joints->setZero(3);
  scene.seen.jacobian.setZero(3, 3);
  scene.seen.mass_kg_m2.setIdentity(3, 3);
  CHECK(scene.tick(5).action == Action::pass);
}

namespace {

/// A scene that presses with a force, the moment after an encoder has jumped.
Scene blind_scene(double force_n) {
  Scene scene;
  scene.force_n = force_n;
  scene.tick(10);
  scene.seen.q_rad[5] += 6e-3;
  scene.tick();
  REQUIRE(scene.verdict.cause == Cause::encoder_jump);
  return scene;
}

}  // namespace

TEST_CASE("an arm that is blind has its joints damped, under the gravity of its last good pose") {
  Scene scene = blind_scene(4.0);
  const JointVector gravity_nm = scene.seen.gravity_nm;
  scene.seen.gravity_nm.array() += 30.0;
  scene.seen.tool_in_base.x() += 0.3;
  scene.proposal.virtual_target_in_base.x() += 0.3;
  for (Eigen::Index joint = 0; joint < 6; ++joint)
    scene.seen.dq_rad_per_s[joint] = 0.1 * static_cast<double>(joint) - 0.2;
  CHECK(scene.tick(10).action == Action::comply);
  CHECK((scene.verdict.allowed_nm - gravity_nm + 8.0 * scene.seen.dq_rad_per_s).norm() < 1e-9);
  scene.retract();  // which knows no way out either
  scene.tick(5);
  CHECK((scene.verdict.allowed_nm - gravity_nm + 8.0 * scene.seen.dq_rad_per_s).norm() < 1e-9);
}

namespace {

/// What a blind scene is told beyond gravity and damping, by the levers that were known before.
Vector3 pushed_n(const Scene& scene, const JointVector& gravity_nm) {
  return (scene.verdict.allowed_nm - gravity_nm + 8.0 * scene.seen.dq_rad_per_s).head<3>() / 0.2;
}

}  // namespace

TEST_CASE("a blind arm that pressed is pushed off by its last good levers, damped") {
  Scene scene = blind_scene(20.0);
  const JointVector gravity_nm = scene.seen.gravity_nm;
  const Vector3 push_n = 40.0 * scene.normal();
  scene.seen.jacobian *= -1.0;
  scene.seen.gravity_nm.array() += 5.0;
  scene.seen.dq_rad_per_s[1] = 0.3;
  scene.tick(5);
  check_same(pushed_n(scene, gravity_nm), push_n);
  scene.force_n = 0.0;  // it goes on for 60 ms, that brakes do not let it sink back
  for (int ms = 6; ms < 60; ++ms) {
    CHECK(scene.tick().action == Action::comply);
    check_same(pushed_n(scene, gravity_nm), push_n);
  }
  CHECK(scene.tick().action == Action::brake);
  CHECK(scene.verdict.allowed_nm == gravity_nm);
}

TEST_CASE("a blind arm is pushed off for as long as it presses, and where it pressed at first") {
  Scene presses = blind_scene(20.0);
  const JointVector gravity_nm = presses.seen.gravity_nm;
  CHECK(presses.tick(200).action == Action::comply);
  check_same(pushed_n(presses, gravity_nm), 40.0 * presses.normal());
  Scene touched = blind_scene(4.0);
  touched.tick(5);
  check_same(pushed_n(touched, gravity_nm), Vector3::Zero());
  touched.force_n = 20.0;  // somebody comes after it
  touched.tick(10);
  check_same(pushed_n(touched, gravity_nm), 40.0 * touched.normal());
  touched.seen.q_rad[5] -= 6e-3;  // a second jump begins nothing anew
  touched.tick();
  touched.force_n = 4.0;
  touched.tick(3);
  check_same(pushed_n(touched, gravity_nm), Vector3::Zero());
}

TEST_CASE("a blind arm is braked once less than 2 N are felt, three ticks after it at once") {
  for (const double force_n : {0.0, 1.99, 2.0, 20.0}) {
    Scene scene;
    scene.face(Vector3::UnitZ());
    scene.noise_n = 0.0;
    scene.force_n = force_n;
    scene.tick(10);
    scene.seen.q_rad[5] += 6e-3;
    CHECK(scene.tick(3).action == Action::comply);
    CHECK(scene.tick().action == (force_n < 2.0 ? Action::brake : Action::comply));
    CHECK(scene.verdict.cause == Cause::encoder_jump);
    CHECK(scene.verdict.latched);
  }
}

TEST_CASE("a blind arm that is still pressed is braked after 0.3 s, and stays so") {
  Scene scene = blind_scene(20.0);
  CHECK(scene.tick(299).action == Action::comply);
  CHECK(scene.tick().action == Action::brake);
  CHECK(scene.verdict.cause == Cause::encoder_jump);
  const JointVector gravity_nm = scene.seen.gravity_nm;
  scene.seen.gravity_nm.array() += 1.0;
  scene.seen.dq_rad_per_s[0] = 0.5;
  CHECK(scene.tick(50).action == Action::brake);
  CHECK(scene.verdict.allowed_nm == gravity_nm);
}

TEST_CASE("a blind arm that somebody pushes along is not braked in their way for two seconds") {
  for (const double rad_per_s : {0.0497, 0.0503, -0.0503}) {
    Scene scene = blind_scene(20.0);
    scene.seen.dq_rad_per_s[1] = rad_per_s;
    const bool pushed = std::abs(rad_per_s) > 0.05;
    CHECK(scene.tick(300).action == (pushed ? Action::comply : Action::brake));
    CHECK(scene.tick(1699).action == (pushed ? Action::comply : Action::brake));
    CHECK(scene.tick().action == Action::brake);
  }
}

TEST_CASE("in a tick that is repeated an encoder may turn as far as in a millisecond") {
  for (const double beyond_rad : {-1e-5, 1e-5}) {
    Scene again;
    again.tick(10);
    again.seen.tick -= 1;
    again.seen.q_rad[2] += 5e-3 + beyond_rad;
    again.tick_at(again.seen.time_s);
    CHECK(again.verdict.cause == (beyond_rad > 0.0 ? Cause::encoder_jump : Cause::late_tick));
  }
}

TEST_CASE("a blind arm is braked as soon as two samples say that nobody is there") {
  Scene scene = blind_scene(20.0);
  scene.tick(70);
  scene.force_n = 0.0;
  CHECK(scene.tick(2).action == Action::comply);  // joints are judged before the sensor is
  CHECK(scene.tick().action == Action::brake);
}
