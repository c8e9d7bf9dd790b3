// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/virtual_arm.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "tests/allocation.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;
using robot::VirtualArm;

namespace {

/// The left arm of a UR before a sitting person, bent, and a virtual arm that stands there.
struct Bent {
  robot::ArmModel model;
  JointVector q_rad;
  VirtualArm arm;
};

Bent bent() {
  const auto ur = robot::load_robot("ur");
  REQUIRE(ur.has_value());
  const robot::RobotPlacement placed = robot::place_robot(*ur, BodyPosture::sitting);
  const robot::ArmModel model(placed.arm, placed.mount, Arm::left);
  const JointVector q_rad = placed.mount.ready_near_rad;
  Bent bent{model, q_rad, VirtualArm(model)};
  bent.arm.stand(q_rad);
  return bent;
}

/// What the wrist sensor says under this contact force.
Wrench felt(const Bent& bent, const Vector3& force_in_base_n) {
  const Vector3 weight_n(0.0, 0.0, -bent.model.table().tool_mass_kg * gravity_m_per_s2);
  const Matrix3 tool_from_base =
      bent.model.base_from_tool(bent.arm.q_rad(), 0.0).linear().inverse();
  return {.force_n = tool_from_base * (force_in_base_n + weight_n), .torque_nm = Vector3::Zero()};
}

/// Torques that press with this force against its own weight.
JointVector pressing(const Bent& bent, const Vector3& force_in_base_n) {
  const auto dynamics = bent.model.evaluate(bent.arm.q_rad(), bent.arm.dq_rad_per_s(), 0.0);
  return dynamics.gravity_nm + dynamics.coriolis_nm +
         dynamics.jacobian.topRows<3>().transpose() * force_in_base_n;
}

Vector3 tool_in_base(const Bent& bent) {
  return bent.model.base_from_tool(bent.arm.q_rad(), 0.0).translation();
}

/// The way its tool presses.
Vector3 inward_of(const Bent& bent) {
  return bent.model.base_from_tool(bent.q_rad, 0.0).linear().col(0);
}

}  // namespace

TEST_CASE("a virtual arm rests where what presses it out is what it presses with") {
  Bent arm = bent();
  const Vector3 inward = inward_of(arm);
  const Vector3 before = tool_in_base(arm);
  for (int ms = 0; ms < 500; ++ms)
    arm.arm.step(pressing(arm, 20.0 * inward), felt(arm, -20.0 * inward), true, 0.0);
  CHECK((tool_in_base(arm) - before).norm() < 1e-6);
}

TEST_CASE("a virtual arm yields to what is felt, and goes where it is pressed, by its own mass") {
  for (const double felt_n : {-1.0, 1.0}) {
    Bent arm = bent();
    const Vector3 inward = inward_of(arm);
    const auto dynamics = arm.model.evaluate(arm.q_rad, JointVector::Zero(6), 0.0);
    const double mass_kg = robot::apparent_mass_kg(dynamics, inward);
    const Vector3 before = tool_in_base(arm);
    for (int ms = 0; ms < 50; ++ms)
      arm.arm.step(pressing(arm, Vector3::Zero()), felt(arm, felt_n * inward), true, 0.0);
    const double way_m = (tool_in_base(arm) - before).dot(inward);
    CHECK(way_m / (0.5 * felt_n / mass_kg * 0.05 * 0.05) == doctest::Approx(1.0).epsilon(0.03));
  }
}

TEST_CASE("an arm that has lost its wrist sensor goes no farther in, whatever the torques want") {
  Bent arm = bent();
  const Vector3 inward = inward_of(arm);
  for (int ms = 0; ms < 20; ++ms)
    arm.arm.step(pressing(arm, 20.0 * inward), felt(arm, -20.0 * inward), true, 0.0);
  const Vector3 before = tool_in_base(arm);
  for (int ms = 0; ms < 300; ++ms) arm.arm.step(pressing(arm, 40.0 * inward), {}, false, 0.0);
  CHECK((tool_in_base(arm) - before).dot(inward) < 0.1e-3);
  for (int ms = 0; ms < 50; ++ms) arm.arm.step(pressing(arm, -10.0 * inward), {}, false, 0.0);
  CHECK((tool_in_base(arm) - before).dot(inward) < -0.5e-3);  // the way back is free
}

TEST_CASE("an arm whose wrist sensor is reversed is not drawn into the body by what it feels") {
  Bent arm = bent();
  const Vector3 inward = inward_of(arm);
  const Vector3 before = tool_in_base(arm);
  for (int ms = 0; ms < 300; ++ms)
    arm.arm.step(pressing(arm, Vector3::Zero()), felt(arm, 20.0 * inward), true, 0.0);
  CHECK((tool_in_base(arm) - before).norm() < 0.1e-3);
}

TEST_CASE("a virtual arm keeps to the speeds and ranges of its table, and stands on no number") {
  Bent arm = bent();
  JointVector torque_nm = arm.model.gravity_nm(arm.q_rad);
  for (int ms = 0; ms < 3000; ++ms) {
    torque_nm[0] = 140.0;
    arm.arm.step(torque_nm, felt(arm, Vector3::Zero()), true, 0.0);
    for (int i = 0; i < arm.model.joints(); ++i) {
      const robot::Link& link = arm.model.table().links[static_cast<std::size_t>(i)];
      REQUIRE(std::abs(arm.arm.dq_rad_per_s()[i]) <= link.speed_limit_rad_per_s * (1.0 + 1e-12));
      REQUIRE(arm.arm.q_rad()[i] <= link.max_rad);
      REQUIRE(arm.arm.q_rad()[i] >= link.min_rad);
    }
  }
  const JointVector there_rad = arm.arm.q_rad();
  torque_nm[2] = std::numeric_limits<double>::quiet_NaN();
  arm.arm.step(torque_nm, {}, true, 0.0);
  CHECK(arm.arm.q_rad() == there_rad);
  CHECK(arm.arm.dq_rad_per_s().isZero());
}

TEST_CASE("a step of a virtual arm takes no memory from the heap") {
  Bent arm = bent();
  const Vector3 inward = inward_of(arm);
  const JointVector torque_nm = pressing(arm, 5.0 * inward);
  const Wrench wrench = felt(arm, -5.0 * inward);
  const std::size_t before = test::allocations();
  for (int ms = 0; ms < 10; ++ms) arm.arm.step(torque_nm, wrench, ms % 2 == 0, 0.0);
  CHECK(test::allocations() == before);
}
