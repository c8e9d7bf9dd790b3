// SPDX-License-Identifier: Apache-2.0
// A tool that has escaped from a person who comes closer.
#include <doctest/doctest.h>

#include <Eigen/LU>

#include "tests/control/still_arm.hpp"

using namespace tuina;
using namespace tuina::control;

namespace {

/// A tool that leaves outward with 0.5 m/s, from a contact in which it was startled or not.
struct Leaving {
  ArmController controller = still_controller();
  ArmState state = at_rest(bent());
  Vector3 normal = tip_pose(bent()).normal_in_base;

  explicit Leaving(bool startled) {
    state.contact_in_base.force_n = 3.0 * normal;
    controller.approach(tip_pose(bent()));
    for (int i = 0; i < 20; ++i) (void)controller.step(state, 0.0, 1e-3);
    REQUIRE(controller.status().mode == Mode::contact);
    state.contact_in_base.force_n = (startled ? 40.0 : 3.0) * normal;
    for (int i = 0; i < 5; ++i) (void)controller.step(state, 0.0, 1e-3);
    state.contact_in_base.force_n.setZero();
    for (int i = 0; i < 20; ++i) (void)controller.step(state, 0.0, 1e-3);
    REQUIRE((controller.status().contact_fault == ContactFault::pushed_away) == startled);
    controller.retract(60_mm);
    go(0.5);
  }
  /// Without turning.
  void go(double outward_m_per_s) {
    robot::Vector6 twist = robot::Vector6::Zero();
    twist.head<3>() = outward_m_per_s * normal;
    state.dq_rad_per_s =
        Eigen::MatrixXd(controller.dynamics().jacobian).partialPivLu().solve(twist);
  }
  /// How much faster the tool becomes, in m/s2.
  double speeds_up() {
    const JointVector torque_nm = controller.step(state, 0.0, 1e-3);
    const robot::ArmDynamics& arm = controller.dynamics();
    const JointVector gains =
        arm.mass_kg_m2.llt().solve(torque_nm - arm.gravity_nm - arm.coriolis_nm);
    return normal.dot(arm.jacobian.topRows<3>() * gains);
  }
};

}  // namespace

TEST_CASE("nothing slows a tool that has escaped until it is well away, or nearly at rest") {
  constexpr double slows = -10.0, keeps_on = -4.0;
  CHECK(Leaving(false).speeds_up() < slows);
  Leaving flies(true);
  const Vector3 from = model.base_from_tool(flies.state.q_rad, 0.0).translation();
  double flown_m = 0.0;
  for (; flown_m < 0.199 && flies.speeds_up() > keeps_on; flies.go(0.5)) {
    CHECK(flies.controller.status().contact_fault == ContactFault::pushed_away);
    flies.state.q_rad += 1e-3 * flies.state.dq_rad_per_s;
    flown_m = (model.base_from_tool(flies.state.q_rad, 0.0).translation() - from).dot(flies.normal);
  }
  CHECK(flown_m > 0.199);
  Leaving followed = flies;
  followed.state.contact_in_base.force_n = 4.1 * flies.normal;
  CHECK(followed.speeds_up() > 10.0);
  flies.state.q_rad += 4e-3 * flies.state.dq_rad_per_s;
  CHECK(flies.speeds_up() < slows);
  Leaving slow(true);
  CHECK(slow.speeds_up() > keeps_on);
  slow.go(0.099);
  (void)slow.speeds_up();
  slow.go(0.5);
  CHECK(slow.speeds_up() < slows);
}
