// SPDX-License-Identifier: Apache-2.0
// What a guard sees of an arm, by a model and a zero of its own.
#include <limits>

#include "tests/safety/two_arms.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

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
  for (const Eigen::Index joints : {5, 7}) {
    for (const bool speeds : {false, true}) {
      Standing arm;
      (speeds ? arm.arm().dq_rad_per_s : arm.arm().q_rad).setZero(joints);
      const Observation seen = arm.watch.observe(arm.reading, Arm::left, {}, JointVector::Zero(6));
      CHECK(seen.q_rad.size() + seen.dq_rad_per_s.size() == 6 + joints);
      CHECK(seen.jacobian.cols() == 0);
    }
    Standing arm;  // torques of other joints are none
    arm.observe_for(5);
    CHECK(arm.watch.observe(arm.reading, Arm::left, {}, JointVector::Constant(joints, 1e6))
              .torque_misfit == 0.0);
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
    arm.observe_for(10, Phase::contact);
    CHECK(arm.observe(Phase::approach).force_in_base_n.norm() < 0.01);
    arm.pushed_n.x() = 1.0;
    arm.observe_for(1000, Phase::retract);
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

TEST_CASE("samples of the wrist that repeat the one before are counted, the same sent again not") {
  Standing arm;
  CHECK(arm.observe().wrist_repeats == 0);
  CHECK(arm.observe_for(5).wrist_repeats == 5);
  arm.pushed_n.x() += 1e-9;
  CHECK(arm.observe().wrist_repeats == 0);
  CHECK(arm.observe_for(3).wrist_repeats == 3);
  arm.arm().wrench_in_tool.torque_nm.z() += 1e-12;
  CHECK(arm.look().wrist_repeats == 0);
  for (int ms = 0; ms < 3; ++ms) {  // with an old stamp
    arm.reading.tick += 1;
    CHECK(arm.watch.observe(arm.reading, Arm::left, {}, {}).wrist_repeats == 0);
  }
  arm.pushed_n.setZero();
  arm.observe();
  arm.arm().dq_rad_per_s.setConstant(0.1);  // it may move meanwhile
  for (int ms = 0; ms < 20; ++ms) arm.look();
  CHECK(arm.look().wrist_repeats == 21);
}
