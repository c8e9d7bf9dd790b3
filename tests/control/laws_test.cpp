// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/allocation.hpp"
#include "tests/control/still_arm.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::control;

TEST_CASE("an arm at rest where it should be is given its weight and nothing else") {
  ArmController controller = still_controller();
  const JointVector torque = controller.step(at_rest(bent()), 0.0, 1e-3);
  CHECK((torque - model.gravity_nm(bent())).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(controller.status().mode == Mode::hold);
}

TEST_CASE("a virtual target pulls the tool's centre with the force of its spring") {
  const JointVector q = bent();
  const auto dynamics = model.evaluate(q, JointVector::Zero(6), 0.0);
  const Vector3 force(3.0, -2.0, 5.0);
  ToolReference reference;
  reference.pose.normal_in_base = tool_normal(dynamics.base_from_tool);
  const JointVector torque =
      task_torque(dynamics, model.table(), q, JointVector::Zero(6), force, reference, q, {}, {});
  const JointVector expected = dynamics.jacobian.topRows<3>().transpose() * force;
  CHECK((torque - expected).norm() < 1e-9);
}

TEST_CASE("what the posture wants does not accelerate the tool") {
  const JointVector q = bent();
  const auto dynamics = model.evaluate(q, JointVector::Zero(6), 0.0);
  ToolReference reference;
  reference.pose.normal_in_base = tool_normal(dynamics.base_from_tool);
  JointVector posture = q;
  posture[2] += 0.4;
  const JointVector torque = task_torque(dynamics, model.table(), q, JointVector::Zero(6),
                                         Vector3::Zero(), reference, posture, {}, {});
  const JointVector acceleration = dynamics.mass_kg_m2.llt().solve(torque);
  const Vector3 tool = dynamics.jacobian.topRows<3>() * acceleration;
  CHECK(acceleration.norm() > 0.5);
  CHECK(tool.norm() < 0.05 * acceleration.norm());
}

TEST_CASE("the law of the thesis refuses a mass below the apparent one unless told to take it") {
  const JointVector q = bent(), still = JointVector::Zero(6);
  const auto dynamics = model.evaluate(q, still, 0.0);
  ToolReference reference;
  reference.pose = {dynamics.base_from_tool.translation() + Vector3(0.0, 0.0, 0.01),
                    tool_normal(dynamics.base_from_tool)};
  const auto torque = [&](double mass_kg, bool allow) {
    return thesis_torque(dynamics, model.table(), q, still, Vector3::Zero(), Vector3(0, 0, 20),
                         reference, q, {.mass_kg = mass_kg, .below_apparent_mass = allow}, {}, {});
  };
  const double apparent = robot::apparent_mass_kg(dynamics, reference.pose.normal_in_base);
  CHECK((torque(0.1, false) - torque(apparent, false)).norm() < 1e-9);
  CHECK((torque(0.1, true) - torque(apparent, false)).norm() > 1.0);
}

TEST_CASE("a target beyond reach and a stretched arm ask for no large torque") {
  JointVector q = JointVector::Zero(6);
  q[3] = 60_deg;
  ArmController controller = still_controller();
  controller.move_to({Vector3(3.0, 0.5, 0.0), -Vector3::UnitX()});
  for (int i = 0; i < 30000; ++i) {
    const JointVector torque = controller.step(at_rest(q), 0.0, 1e-3);
    REQUIRE(torque.allFinite());
    REQUIRE(torque.cwiseAbs().maxCoeff() < 50.0);
  }
}

TEST_CASE("springs pull less into the body than it bears, by a way out that is ten degrees off") {
  ArmController controller = still_controller();
  ArmState state = at_rest(bent());
  const ToolPose tip = tip_pose(bent());
  const Vector3 normal = tip.normal_in_base, aside = normal.unitOrthogonal();
  state.contact_in_base.force_n = 3.0 * normal;
  controller.approach(tip);
  for (int i = 0; i < 20; ++i) (void)controller.step(state, 0.0, 1e-3);
  REQUIRE(controller.status().mode == Mode::contact);
  for (const double aside_m : {0.0, 3_mm, 50_mm}) {
    // It is felt too little, so the spring along the normal is soon as strong as it may be.
    controller.track({.at_in_base = tip.at_in_base + aside_m * aside,
                      .normal_in_base = normal,
                      .force_n = 10.0,
                      .max_spring_n = 14.5});
    for (int i = 0; i < 3000; ++i) (void)controller.step(state, 0.0, 1e-3);
    const Vector3 pull_n =
        controller.status().stiffness_n_per_m *
        (controller.status().virtual_target_in_base - state.base_from_tool.translation());
    const Vector3 way_out = std::cos(10_deg) * normal - std::sin(10_deg) * aside;
    CHECK(-pull_n.dot(way_out) < 14.5);
    CHECK(-pull_n.dot(normal) > (aside_m > 10_mm ? 9.0 : 13.3));
  }
}

TEST_CASE(
    "an arm that is led by a hand follows it, stays where it was left, and then obeys again") {
  ArmController::Options options;
  options.learn_s = 0.0;
  options.friction.share_of_table = 0.0;  // this arm has none
  ArmController controller(model, options);
  ArmState state = at_rest(bent());
  controller.start(state);
  controller.lead();
  const Vector3 start = state.base_from_tool.translation(), hand_n(0.0, 6.0, -8.0);
  Vector3 released = start;
  const auto live = [&](int ticks, const Vector3& push_n) {
    for (int i = 0; i < ticks; ++i) {
      const auto dynamics = model.evaluate(state.q_rad, state.dq_rad_per_s, 0.0);
      const JointVector torque = controller.step(state, 0.0, 1e-3) - dynamics.gravity_nm -
                                 dynamics.coriolis_nm +
                                 dynamics.jacobian.topRows<3>().transpose() * push_n;
      state.dq_rad_per_s += 1e-3 * dynamics.mass_kg_m2.llt().solve(torque);
      state.q_rad += 1e-3 * state.dq_rad_per_s;
      state.base_from_tool = model.base_from_tool(state.q_rad, 0.0);
    }
  };
  live(600, hand_n);
  released = state.base_from_tool.translation();
  CHECK((released - start).dot(hand_n.normalized()) > 0.05);
  live(1500, Vector3::Zero());
  const Vector3 left = state.base_from_tool.translation();
  CHECK((left - released).dot(hand_n) > 0.0);  // it coasts on a little and does not come back
  CHECK((state.dq_rad_per_s).cwiseAbs().maxCoeff() < 0.02);
  controller.hold();
  live(1000, Vector3::Zero());
  CHECK((state.base_from_tool.translation() - left).norm() < 5e-3);
  CHECK(controller.status().mode == Mode::hold);
}

TEST_CASE("what a push taught an arm about its place is forgotten when it is led or starts anew") {
  ArmController::Options options;
  options.learn_s = 0.0;
  options.friction.share_of_table = 0.0;  // this arm has none
  for (const bool led : {true, false}) {
    ArmController controller(model, options);
    ArmState state = at_rest(bent());
    controller.start(state);
    state.q_rad[1] += 0.04;  // a hand holds the tool beside its place
    state.base_from_tool = model.base_from_tool(state.q_rad, 0.0);
    for (int i = 0; i < 2000; ++i) {
      (void)controller.step(state, 0.0, 1e-3);
    }
    const auto drive_n = [&] {
      const JointVector torque = controller.step(state, 0.0, 1e-3);
      return (torque - model.evaluate(state.q_rad, state.dq_rad_per_s, 0.0).gravity_nm).norm();
    };
    CHECK(drive_n() > 5.0);
    if (led) {
      controller.lead();
      controller.hold();
    } else {
      controller.start(state);
    }
    CHECK(drive_n() < 0.5);
  }
}

TEST_CASE("commands that are no numbers leave the arm where it is and say so") {
  const double bad = std::numeric_limits<double>::quiet_NaN();
  ArmController controller = still_controller();
  controller.move_to({Vector3(bad, 0.0, 0.0), Vector3::UnitX()});
  CHECK(controller.status().contact_fault == ContactFault::bad_command);
  controller.approach({Vector3(bad, 0.0, 0.0), Vector3::UnitX()});
  CHECK(controller.status().contact_fault == ContactFault::bad_command);
  controller.approach({Vector3::Zero(), Vector3::Zero()});
  CHECK(controller.status().contact_fault == ContactFault::bad_command);
  CHECK(controller.step(at_rest(bent()), 0.0, 1e-3).allFinite());
}

TEST_CASE("a sample that is no number and a tick without length leave no trace") {
  const double bad = std::numeric_limits<double>::quiet_NaN();
  ArmState moved = at_rest(bent());
  moved.q_rad[1] += 0.01;
  moved.base_from_tool = model.base_from_tool(moved.q_rad, 0.0);
  ArmController calm = still_controller(), disturbed = still_controller();
  for (int i = 0; i < 50; ++i) {
    const JointVector torque = calm.step(moved, 0.0, 1e-3);
    CHECK(disturbed.step(moved, 0.0, 1e-3) == torque);
    ArmState broken = moved;
    double& value = i % 4 == 0   ? broken.q_rad[2]
                    : i % 4 == 1 ? broken.dq_rad_per_s[0]
                    : i % 4 == 2 ? broken.base_from_tool(0, 3)
                                 : broken.contact_in_base.force_n.x();
    value = bad;
    CHECK(disturbed.step(broken, 0.0, 1e-3) == torque);
    CHECK(disturbed.step(moved, bad, 1e-3) == torque);
    CHECK(disturbed.step(moved, 0.0, 0.0) == torque);
    disturbed.start(broken);
    CHECK(disturbed.status().contact_fault == ContactFault::bad_command);
  }
}

TEST_CASE("the wrist's zero error and the tool's weight are not a contact") {
  ArmSense sense(model);
  robot::ArmReading reading{.q_rad = bent(), .dq_rad_per_s = JointVector::Zero(6)};
  const Matrix3 tool_from_base = model.base_from_tool(bent(), 0.0).linear().transpose();
  const Vector3 weight(0.0, 0.0, -model.table().tool_mass_kg * gravity_m_per_s2);
  reading.wrench_in_tool.force_n = tool_from_base * weight + Vector3(0.8, -0.5, 0.3);
  for (int i = 0; i < 500; ++i) (void)sense.sense(reading, i * 1e-3, 0.0);
  sense.tare();
  CHECK(sense.sense(reading, 0.5, 0.0).contact_in_base.force_n.norm() < 1e-9);
  reading.wrench_in_tool.force_n += tool_from_base * Vector3(0.0, 0.0, 7.0);
  CHECK((sense.sense(reading, 0.501, 0.0).contact_in_base.force_n - Vector3(0, 0, 7)).norm() <
        1e-9);
}

TEST_CASE("one wild sample of the wrist does not reach the law, a lasting one does") {
  ArmSense sense(model);
  robot::ArmReading reading{.q_rad = bent(), .dq_rad_per_s = JointVector::Zero(6)};
  const Vector3 quiet = sense.sense(reading, 0.0, 0.0).contact_in_base.force_n;
  reading.wrench_in_tool.force_n.x() = 400.0;
  CHECK((sense.sense(reading, 1e-3, 0.0).contact_in_base.force_n - quiet).norm() < 1e-9);
  CHECK((sense.sense(reading, 2e-3, 0.0).contact_in_base.force_n - quiet).norm() < 1e-9);
  CHECK(sense.sense(reading, 3e-3, 0.0).contact_in_base.force_n.norm() > 300.0);
}

TEST_CASE("friction is learned from an arm moved to and fro, gravity error apart") {
  FrictionCompensation friction(model.table(), {});
  friction.start(JointVector::Zero(6));
  friction.begin_learning();
  JointVector q = JointVector::Zero(6);
  const double truth_nm = 1.7, windup_rad = 0.3e-3;
  double wound = 0.0, last = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 0.02 * std::sin(2.0 * pi * i * 1e-3);
    const double turned = (angle - last) / windup_rad;
    wound = std::clamp(wound + turned * (1.0 - wound * (turned > 0.0 ? 1.0 : -1.0)), -1.0, 1.0);
    last = angle;
    q.setConstant(angle);
    (void)friction.step(q);
    friction.learn(JointVector::Constant(6, truth_nm * wound + 0.9), JointVector::Zero(6));
  }
  friction.end_learning();
  for (int i = 0; i < 6; ++i)
    CHECK(friction.coulomb_nm()[i] ==
          doctest::Approx(FrictionCompensation::Options().share * truth_nm));
}

TEST_CASE("a tick of both arms takes no memory from the heap, in any phase") {
  ArmController controller = still_controller();
  ArmState state = at_rest(bent());
  const ToolPose skin = tip_pose(bent());
  const auto before = test::allocations();
  for (int i = 0; i < 10; ++i) (void)controller.step(state, 0.0, 1e-3);
  controller.move_to({skin.at_in_base + 0.05 * skin.normal_in_base, skin.normal_in_base});
  for (int i = 0; i < 10; ++i) (void)controller.step(state, 0.0, 1e-3);
  controller.approach(skin);
  for (int i = 0; i < 10; ++i) (void)controller.step(state, 0.0, 1e-3);
  state.contact_in_base.force_n = 5.0 * skin.normal_in_base;
  for (int i = 0; i < 10; ++i) (void)controller.step(state, 0.0, 1e-3);
  const Mode then = controller.status().mode;
  for (int i = 0; i < 10; ++i) {
    controller.track(
        {.at_in_base = skin.at_in_base, .normal_in_base = skin.normal_in_base, .force_n = 20.0});
    (void)controller.step(state, 0.0, 1e-3);
  }
  controller.retract(0.04);
  for (int i = 0; i < 10; ++i) (void)controller.step(state, 0.0, 1e-3);
  const auto after = test::allocations();
  CHECK(after == before);
  CHECK(then == Mode::contact);
}
