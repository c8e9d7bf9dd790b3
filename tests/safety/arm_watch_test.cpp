// SPDX-License-Identifier: Apache-2.0
// What a guard sees of an arm, by a model and a zero of its own.
#include "tuina/safety/arm_watch.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "tests/safety/two_arms.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// An arm that stands, watched; `pushed_n` is felt at its tool.
struct Standing {
  robot::ArmModel model = two_arms()[Arm::left];
  ArmWatch watch{model};
  robot::RobotReading reading;
  Vector3 pushed_n = Vector3::Zero();
  JointVector extra_nm = JointVector::Zero(6);  ///< beyond what holds the arm
  double stiffness_n_per_m = 0.0;               ///< of the controller; 0: a hand leads the arm

  Standing() {
    reading.arms[Arm::left].q_rad = bent();
    reading.arms[Arm::left].dq_rad_per_s = JointVector::Zero(6);
  }
  robot::ArmReading& arm() { return reading.arms[Arm::left]; }
  Observation observe(Phase phase = Phase::free) {
    arm().wrench_in_tool = wrist_of(model, arm().q_rad, pushed_n);
    return look(phase);
  }
  /// As it is in the reading.
  Observation look(Phase phase = Phase::free) {
    reading.tick += 1;
    reading.time_s += 1e-3;
    arm().wrench_time_s = reading.time_s - 1e-3;
    const auto dynamics = model.evaluate(arm().q_rad, JointVector::Zero(6), 0.0);
    const JointVector held_nm =
        dynamics.gravity_nm - dynamics.jacobian.topRows<3>().transpose() * pushed_n + extra_nm;
    return watch.observe(reading, Arm::left,
                         {.phase = phase, .stiffness_n_per_m = stiffness_n_per_m}, held_nm);
  }
  Observation observe_for(int ticks, Phase phase = Phase::free) {
    Observation seen;
    for (int i = 0; i < ticks; ++i) seen = observe(phase);
    return seen;
  }
};

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
    arm.q_rad = q_rad, arm.dq_rad_per_s = dq_rad_per_s;
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

TEST_CASE("an arm is seen where its own model says, with the weight of the tool taken off") {
  Standing arm;
  arm.arm().dq_rad_per_s = JointVector::LinSpaced(6, -0.2, 0.3);
  arm.pushed_n = {3.0, -5.0, 20.0};
  arm.reading.tick = 41;
  const Observation seen = arm.observe();
  const auto dynamics = arm.model.evaluate(bent(), arm.arm().dq_rad_per_s, 0.0);
  CHECK(seen.tick == 42);
  CHECK(seen.time_s == arm.reading.time_s);
  CHECK(seen.wrench_time_s == arm.arm().wrench_time_s);
  CHECK(seen.q_rad == bent());
  CHECK(seen.dq_rad_per_s == arm.arm().dq_rad_per_s);
  CHECK((seen.force_in_base_n - arm.pushed_n).norm() < 0.01);
  CHECK(seen.tool_in_base == dynamics.base_from_tool.translation());
  CHECK(seen.jacobian == dynamics.jacobian.topRows<3>());
  CHECK((seen.tool_velocity_m_per_s - seen.jacobian * seen.dq_rad_per_s).norm() < 1e-12);
  CHECK(seen.gravity_nm == dynamics.gravity_nm);
  CHECK(seen.mass_kg_m2 == dynamics.mass_kg_m2);
  CHECK((seen.tip_in_base - seen.tool_in_base - 17e-3 * dynamics.base_from_tool.linear().col(0))
            .norm() < 1e-12);
  CHECK(seen.skin == nullptr);
}

TEST_CASE("an arm on a linear base is where the base has brought it") {
  Standing arm;
  const Vector3 before = arm.observe().tool_in_base;
  arm.reading.rail_m = 0.2;
  CHECK((arm.observe().tool_in_base - before - 0.2 * Vector3::UnitX()).norm() < 1e-12);
}

TEST_CASE("joints of another number are passed on as they are") {
  for (const bool speeds : {false, true}) {
    Standing arm;
    (speeds ? arm.arm().dq_rad_per_s : arm.arm().q_rad).setZero(5);
    const Observation seen = arm.watch.observe(arm.reading, Arm::left, {}, JointVector::Zero(6));
    CHECK(seen.q_rad.size() + seen.dq_rad_per_s.size() == 11);
    CHECK(seen.jacobian.cols() == 0);
  }
}

TEST_CASE("a wrist that says NaN is seen to, be it in its forces or its torques") {
  for (const bool of_torques : {false, true}) {
    Standing arm;
    arm.pushed_n = {0.0, 0.0, 5.0};
    arm.observe_for(50);
    auto& wrench = arm.arm().wrench_in_tool;
    (of_torques ? wrench.torque_nm : wrench.force_n).y() = not_a_number;
    CHECK_FALSE(arm.look().force_in_base_n.allFinite());
    arm.observe_for(50, Phase::approach);  // which is zeroed by what it felt before
    CHECK(arm.observe().force_in_base_n.allFinite());
  }
}

TEST_CASE("when an approach begins the wrist is zeroed, by 3 N at most in all") {
  for (const double drift_n : {1.0, 3.0, 4.0, 30.0}) {
    Standing arm;
    arm.pushed_n = drift_n * Vector3(0.6, 0.0, 0.8);
    CHECK((arm.observe_for(300).force_in_base_n - arm.pushed_n).norm() < 1e-9);
    const double left_n = std::max(drift_n - 3.0, 0.0);
    CHECK((arm.observe(Phase::approach).force_in_base_n - left_n / drift_n * arm.pushed_n).norm() <
          1e-9);
    arm.pushed_n.setZero();  // and stays so, for this approach and what follows
    const double taken_n = std::min(drift_n, 3.0);
    CHECK(arm.observe_for(300, Phase::approach).force_in_base_n.norm() == doctest::Approx(taken_n));
    CHECK(arm.observe_for(300, Phase::contact).force_in_base_n.norm() == doctest::Approx(taken_n));
    CHECK(arm.observe_for(300, Phase::free).force_in_base_n.norm() == doctest::Approx(taken_n));
    CHECK(arm.observe(Phase::approach).force_in_base_n.norm() < 0.01);
  }
}

TEST_CASE("the zero is what was felt in the last tenth of a second, not one sample") {
  Standing arm;
  arm.observe_for(1000);
  arm.pushed_n = {0.0, 0.0, 2.0};
  CHECK(arm.observe(Phase::approach).force_in_base_n.z() == doctest::Approx(0.99 * 2.0));
  Standing slow;
  slow.observe_for(1000);
  slow.pushed_n = {0.0, 0.0, 2.0};
  slow.observe_for(99);
  CHECK(slow.observe(Phase::approach).force_in_base_n.z() ==
        doctest::Approx(2.0 * std::pow(0.99, 100)));
  Standing first;  // the first sample is all that is known
  first.pushed_n = {0.0, 0.0, 2.0};
  CHECK(first.observe(Phase::approach).force_in_base_n.norm() < 1e-9);
}

TEST_CASE(
    "a sound arm that stands explains its torques, up to friction and a twenty-fifth of its "
    "drives; "
    "one that a hand leads, a tenth") {
  const std::array<double, 6> led_nm = {15.75, 15.75, 9.25, 9.25, 2.75, 2.75};
  const std::array<double, 6> driven_nm = {8.55, 8.55, 5.05, 5.05, 1.55, 1.55};
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    for (const double direction : {1.0, -1.0}) {
      Standing arm;
      arm.stiffness_n_per_m = direction > 0.0 ? 0.0 : 1e-9;
      arm.pushed_n = {2.0, -3.0, 15.0};
      CHECK(arm.observe_for(50).torque_misfit < 1e-3);
      const auto& allowed_nm = direction > 0.0 ? led_nm : driven_nm;
      arm.extra_nm[joint] = direction * allowed_nm[static_cast<std::size_t>(joint)];
      CHECK(arm.observe_for(10).torque_misfit == doctest::Approx(0.5).epsilon(1e-3));
      CHECK(arm.observe_for(10).torque_misfit == doctest::Approx(1.0).epsilon(1e-3));
      CHECK(arm.observe_for(10).torque_misfit == doctest::Approx(1.0).epsilon(1e-3));
      arm.extra_nm.setZero();
      CHECK(arm.observe_for(20).torque_misfit < 1e-3);
    }
  }
}

TEST_CASE("nothing is compared before twenty milliseconds are known") {
  Standing arm;
  arm.extra_nm.setConstant(100.0);
  CHECK(arm.watch.observe(arm.reading, Arm::left, {}, {}).torque_misfit == 0.0);
  CHECK(arm.observe_for(20).torque_misfit == 0.0);
  CHECK(arm.observe().torque_misfit > 1.0);
}

TEST_CASE("what turns the wrist explains torques too") {
  Standing arm;
  arm.observe_for(30);
  const auto dynamics = arm.model.evaluate(bent(), JointVector::Zero(6), 0.0);
  const Vector3 turning_nm(0.0, 0.0, 2.0);
  arm.arm().wrench_in_tool.torque_nm = dynamics.base_from_tool.linear().transpose() * turning_nm;
  arm.extra_nm = -dynamics.jacobian.bottomRows<3>().transpose() * turning_nm;
  Observation seen;
  for (int i = 0; i < 40; ++i) seen = arm.look();
  CHECK(seen.torque_misfit < 1e-3);
}

TEST_CASE("a wrist that is no number for a moment leaves what was found of the torques") {
  Standing arm;
  arm.extra_nm[3] = 20.0;
  const double found = arm.observe_for(40).torque_misfit;
  REQUIRE(found > 2.0);
  arm.arm().wrench_in_tool.torque_nm.x() = not_a_number;
  CHECK(arm.look().torque_misfit == found);
}

TEST_CASE("an arm of other masses and friction is believed, reversed and dead drives are not") {
  for (const double mass_scale : {0.85, 1.15}) {
    Moving arm(mass_scale, 2.0 - mass_scale * 1.2);
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
    }
  }
}
