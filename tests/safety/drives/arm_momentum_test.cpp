// SPDX-License-Identifier: Apache-2.0
// Whether the joints of an arm move as their torques and the wrist sensor say.
#include <Eigen/Cholesky>

#include "tests/safety/scene.hpp"
#include "tests/safety/two_arms.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// An arm that moves as its equation of motion says, with friction; the watch believes a table of
/// other masses and friction.
struct Moving {
  robot::ArmModel believed = two_arms()[Arm::left];
  robot::ArmModel real;
  ArmWatch watch{believed};
  robot::RobotReading reading;
  JointVector q_rad = bent(), dq_rad_per_s = JointVector::Zero(6);
  JointVector gain = JointVector::Ones(6);  ///< of the drives: -1 is a reversed one, 0 a dead one
  Eigen::Index frozen = -1;                 ///< joint whose encoder stands still
  double max_misfit = 0.0;

  explicit Moving(double mass_scale = 1.0, double friction_scale = 1.0)
      : real(changed(mass_scale, friction_scale)) {
    sense();
  }
  static robot::ArmModel changed(double mass_scale, double friction_scale) {
    robot::ArmTable table = six_joint_arm();
    for (robot::Link& link : table.links) {
      link.mass_kg *= mass_scale;
      link.coulomb_nm *= friction_scale, link.viscous_nm_s_per_rad *= friction_scale;
    }
    return {table, {}, Arm::left};
  }
  void sense() {
    robot::ArmReading& arm = reading.arms[Arm::left];
    const robot::ArmReading before = arm;
    if (arm.dq_rad_per_s.size() == 0) arm.dq_rad_per_s = dq_rad_per_s;
    arm.q_rad = q_rad, arm.dq_rad_per_s += 0.5 * (dq_rad_per_s - arm.dq_rad_per_s);
    if (frozen >= 0) arm.q_rad[frozen] = before.q_rad[frozen], arm.dq_rad_per_s[frozen] = 0.0;
    arm.wrench_in_tool = wrist_of(believed, arm.q_rad, Vector3::Zero());
  }
  /// One millisecond under a controller that swings the arm to and fro.
  void step(int ms) {
    const robot::ArmReading& arm = reading.arms[Arm::left];
    const double swing_rad = 0.2 * std::sin(2.0 * pi * 0.5 * 1e-3 * ms);
    const JointVector wanted_rad = bent().array() + swing_rad;
    const JointVector limit_nm = believed.table().torque_limits_nm();
    JointVector torque_nm =
        believed.gravity_nm(arm.q_rad) + 60.0 * (wanted_rad - arm.q_rad) - 8.0 * arm.dq_rad_per_s;
    torque_nm = torque_nm.cwiseMin(limit_nm).cwiseMax(-limit_nm);
    for (int part = 0; part < 2; ++part) {
      const auto dynamics = real.evaluate(q_rad, dq_rad_per_s, 0.0);
      JointVector driven_nm = gain.cwiseProduct(torque_nm);
      for (Eigen::Index i = 0; i < 6; ++i) {
        const robot::Link& link = real.table().links[static_cast<std::size_t>(i)];
        driven_nm[i] -= link.coulomb_nm * std::tanh(dq_rad_per_s[i] / 0.01) +
                        link.viscous_nm_s_per_rad * dq_rad_per_s[i];
      }
      const JointVector ddq = dynamics.mass_kg_m2.llt().solve(
          JointVector(driven_nm - dynamics.coriolis_nm - dynamics.gravity_nm));
      dq_rad_per_s += 0.5e-3 * ddq;
      q_rad += 0.5e-3 * dq_rad_per_s;
    }
    sense();
    reading.tick += 1;
    reading.time_s += 1e-3;
    max_misfit =
        std::max(max_misfit, watch.observe(reading, Arm::left, {}, torque_nm).torque_misfit);
  }
  /// Half a second in which all is well.
  void swing() {
    for (int ms = 0; ms < 500; ++ms) step(ms);
    REQUIRE(max_misfit < 1.0);
  }
  /// How many milliseconds more it takes until torques and motion disagree, at most 700.
  int until_noticed() {
    for (int ms = 0; ms < 700; ++ms) {
      step(500 + ms);
      if (max_misfit > 1.0) return ms;
    }
    return 700;
  }
};

}  // namespace

TEST_CASE(
    "a sound arm that stands explains its torques, up to friction and a twenty-fifth of its "
    "drives; one that a hand leads, a tenth") {
  const std::array<double, 6> led_nm = {15.75, 15.75, 9.25, 9.25, 2.75, 2.75};
  const std::array<double, 6> driven_nm = {8.55, 8.55, 5.05, 5.05, 1.55, 1.55};
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    for (const double direction : {1.0, -1.0}) {
      Standing arm;
      arm.stiffness_n_per_m = direction > 0.0 ? 0.0 : 1e-9;
      arm.pushed_n = {2.0, -3.0, 15.0};
      const double allowed_nm = (direction > 0.0 ? led_nm : driven_nm)[static_cast<size_t>(joint)];
      arm.extra_nm[joint] = direction * (allowed_nm - 0.01);
      CHECK(arm.observe_for(1000).torque_misfit == 0.0);
      // What is beyond counts by what 0.05 rad/s and a quarter of a millisecond of the drive are.
      arm.extra_nm[joint] = direction * (allowed_nm + 1.0);
      const Observation seen = arm.observe_for(600);  // until lag and gears have settled
      const double limit_nm = arm.model.table().torque_limits_nm()[joint];
      const double borne = 0.05 * seen.mass_kg_m2(joint, joint) + 0.25e-3 * limit_nm;
      CHECK(arm.observe_for(20).torque_misfit - seen.torque_misfit ==
            doctest::Approx(20e-3 / borne).epsilon(1e-3));
      arm.extra_nm.setZero();
      CHECK(arm.observe_for(600).torque_misfit == 0.0);
    }
  }
}

TEST_CASE("a joint that lacks momentum alone, the way it is driven, has a weak drive") {
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    for (const double direction : {1.0, -1.0}) {
      Standing arm;
      arm.extra_nm[joint] = direction * 60.0;
      Observation seen = arm.observe_for(30);
      CHECK(seen.torque_misfit > 1.0);
      CHECK(seen.weak_joint == joint);
      // Two that lack as much are no matter of one drive.
      const Eigen::Index other = (joint + 2) % 6;
      arm.extra_nm[other] = 60.0;
      arm.extra_nm[joint] = 0.0;
      int both = 0;
      for (int ms = 0; ms < 300; ++ms) {
        const int weak = arm.observe().weak_joint;
        CHECK((weak == -1 || weak == joint || weak == other));
        both += weak == -1 ? 1 : 0;
      }
      CHECK(both > 0);
    }
  }
  Standing driven;  // one that has more than its drive gives is led by somebody else
  driven.pushed_n = {0.0, 0.0, 150.0};
  CHECK(driven.observe_for(30).weak_joint == -1);
  const auto dynamics = driven.model.evaluate(bent(), JointVector::Zero(6), 0.0);
  const JointVector held_nm =
      dynamics.gravity_nm - dynamics.jacobian.topRows<3>().transpose() * driven.pushed_n;
  Eigen::Index joint = 0;
  REQUIRE(held_nm.cwiseAbs().maxCoeff(&joint) > 30.0);
  driven.extra_nm[joint] = held_nm[joint] > 0.0 ? -25.0 : 25.0;
  const Observation seen = driven.observe_for(50);
  CHECK(seen.torque_misfit > 1.0);
  CHECK(seen.weak_joint == -1);
}

TEST_CASE("the first reading is compared with none, missed ones take their time") {
  Standing arm;
  arm.extra_nm.setConstant(100.0);
  CHECK(arm.watch.observe(arm.reading, Arm::left, {}, {}).torque_misfit == 0.0);
  CHECK(arm.observe().torque_misfit > 1.0);
  const auto misfit_after = [](std::uint64_t missed) {
    Standing late;
    late.observe_for(10);
    late.extra_nm[2] = 100.0;
    late.reading.tick += missed;
    return late.observe().torque_misfit;
  };
  CHECK(misfit_after(1) == doctest::Approx(2.0 * misfit_after(0)).epsilon(1e-6));
  CHECK(misfit_after(9) == doctest::Approx(10.0 * misfit_after(0)).epsilon(1e-6));
  CHECK(misfit_after(1000) == misfit_after(9));
  CHECK(misfit_after(~std::uint64_t{0}) == 0.0);  // the same tick again
}

TEST_CASE("a wild sample or two of the wrist are not taken for a fault of the drives") {
  for (const bool turning : {false, true}) {
    Standing arm;
    arm.stiffness_n_per_m = 1.0;
    arm.observe_for(50);
    for (int sample = 0; sample < 2; ++sample) {
      arm.arm().wrench_in_tool = wrist_of(arm.model, arm.arm().q_rad, Vector3::Zero());
      auto& wrench = arm.arm().wrench_in_tool;
      (turning ? wrench.torque_nm : wrench.force_n).y() += 500.0;
      CHECK(arm.look().torque_misfit < 0.7);
    }
    for (int ms = 0; ms < 10; ++ms) CHECK(arm.observe().torque_misfit < 0.7);
  }
}

TEST_CASE("what turns the wrist explains torques too") {
  Standing arm;
  arm.observe_for(30);
  const auto dynamics = arm.model.evaluate(bent(), JointVector::Zero(6), 0.0);
  const Vector3 turning_nm(0.0, 0.0, 2.0);
  arm.arm().wrench_in_tool.torque_nm = dynamics.base_from_tool.linear().transpose() * turning_nm;
  arm.extra_nm = -dynamics.jacobian.bottomRows<3>().transpose() * turning_nm;
  Observation seen;
  for (int i = 0; i < 400; ++i) seen = arm.look();
  CHECK(seen.torque_misfit < 0.5);
}

TEST_CASE("a wrist that is no number for a moment counts as it was before") {
  for (const bool first : {false, true}) {
    Standing arm;
    arm.stiffness_n_per_m = 1.0;
    arm.pushed_n = {0.0, 0.0, 40.0};
    if (!first) arm.observe_for(20);
    Observation seen;
    for (int ms = 0; ms < 100; ++ms) {
      arm.arm().wrench_in_tool = wrist_of(arm.model, arm.arm().q_rad, arm.pushed_n);
      arm.arm().wrench_in_tool.torque_nm.x() = not_a_number;
      seen = arm.look();
    }
    CHECK((seen.torque_misfit == 0.0) == !first);
  }
}

TEST_CASE("an arm of other masses and friction is believed, reversed and dead drives are not") {
  for (const double mass_scale : {0.85, 1.15}) {
    Moving arm(mass_scale, 2.0 - mass_scale * 1.2);
    arm.swing();
    CHECK(arm.until_noticed() == 700);
  }
  for (const Eigen::Index joint : {1, 3}) {
    for (const double gain : {-1.0, 0.0}) {
      Moving arm;
      arm.swing();
      arm.gain[joint] = gain;
      CAPTURE(joint);
      CAPTURE(gain);
      CHECK(arm.until_noticed() < 600);
    }
  }
}

TEST_CASE("an encoder that stands still while a sound arm moves is noticed") {
  for (const Eigen::Index joint : {1, 3}) {
    Moving arm;
    arm.swing();
    arm.frozen = joint;
    CAPTURE(joint);
    CHECK(arm.until_noticed() < 600);
  }
}

TEST_CASE("a joint that leans against its stop may be held by that") {
  for (const bool high : {true, false}) {
    for (const double from_stop_rad : {0.0199, 0.0201}) {
      Standing arm;
      const robot::Link& link = arm.model.table().links[3];
      arm.arm().q_rad[3] = high ? link.max_rad - from_stop_rad : link.min_rad + from_stop_rad;
      arm.extra_nm[3] = 30.0;
      const double found = arm.observe_for(40).torque_misfit;
      CHECK((found > 1.0) == (from_stop_rad > 0.02));
      arm.arm().q_rad[3] = 0.0;  // off it, all that is missing counts at once
      CHECK(arm.observe().torque_misfit > 0.0);
    }
  }
}

TEST_CASE("what turns with the arm, and friction that grows with speed, are explained") {
  for (const double speed : {10.0, -10.0}) {
    Standing arm;
    arm.stiffness_n_per_m = 1.0;
    arm.arm().dq_rad_per_s.setConstant(speed);
    const auto dynamics = arm.model.evaluate(bent(), arm.arm().dq_rad_per_s, 0.0);
    REQUIRE(dynamics.coriolis_nm.cwiseAbs().maxCoeff() > 10.0);
    arm.extra_nm = dynamics.coriolis_nm;
    CHECK(arm.observe_for(300).torque_misfit == 0.0);
    // 2.5 Nm and 0.2 Nm s of the first joint, at 10 rad/s, and a twenty-fifth of 120 Nm.
    arm.extra_nm[0] += 1.5 * (2.5 + 0.2 * 10.0) + 4.8 - 0.01;
    CHECK(arm.observe_for(300).torque_misfit == 0.0);
    arm.extra_nm[0] += 0.02;
    CHECK(arm.observe_for(300).torque_misfit > 0.0);
  }
}

TEST_CASE("who tells of a spring against all sense is judged as narrowly as one with a spring") {
  Standing arm;
  arm.stiffness_n_per_m = -1.0;
  arm.extra_nm[0] = 12.0;
  CHECK(arm.observe_for(300).torque_misfit > 1.0);
}
