// SPDX-License-Identifier: Apache-2.0
// An arm that does not do what it is told.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

Scene leaving(double felt_n = 20.0) {
  Scene scene;
  scene.force_n = felt_n;
  scene.tick(10);
  scene.retract();
  return scene;
}

}  // namespace

TEST_CASE("an arm that goes inward against 80 N outward for 50 ms is braked") {
  const auto going = [](double inward_m_per_s, int ticks, double felt_n = 20.0) {
    Scene scene = leaving(felt_n);
    scene.seen.tool_velocity_m_per_s = -inward_m_per_s * scene.normal();
    return scene.tick(ticks);
  };
  CHECK(going(0.0501, 49).action == Action::retract);
  CHECK(going(0.0501, 50).action == Action::brake);
  CHECK(going(0.0501, 50).cause == Cause::set_force_too_high);  // the first cause stays
  CHECK(going(0.0499, 500).action == Action::retract);
  CHECK(going(-0.2, 500).action == Action::retract);
  CHECK(going(0.0501, 500, 4.0).action == Action::retract);  // nobody is there
  Scene scene = leaving();
  for (int i = 0; i < 5; ++i) {  // it must last
    scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
    CHECK(scene.tick(49).action == Action::retract);
    scene.seen.tool_velocity_m_per_s.setZero();
    CHECK(scene.tick().action == Action::retract);
  }
}

TEST_CASE("only a retreat is disobeyed by going inward") {
  Scene scene;
  scene.tick(10);
  scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
  CHECK(scene.tick(200).action == Action::pass);
  scene.comply();
  CHECK(scene.tick(200).action == Action::comply);
}

TEST_CASE("an arm that races at more than 1.2 m/s for ten ticks under the guard is braked") {
  const auto racing = [](Action action, double m_per_s, int ticks) {
    Scene scene;
    scene.force_n = 0.0;
    scene.proposal.phase = Phase::free;
    scene.tick(10);
    scene.guard.stop(action, Cause::arms_too_close);
    scene.tick();
    scene.seen.tool_velocity_m_per_s = m_per_s * scene.normal();
    return scene.tick(ticks).action;
  };
  for (const Action action : {Action::comply, Action::retract}) {
    CHECK(racing(action, 1.201, 9) == action);
    CHECK(racing(action, 1.201, 10) == Action::brake);
    CHECK(racing(action, 1.199, 100) == action);
    CHECK(racing(action, -1.201, 10) == Action::brake);
  }
  // One that is frozen or free is stopped by its speed first.
  for (const Action action : {Action::pass, Action::freeze}) {
    CHECK(racing(action, 1.201, 12) == Action::comply);
    CHECK(racing(action, 1.201, 13) == Action::brake);
  }
  Scene scene = leaving();
  for (int i = 0; i < 5; ++i) {
    scene.seen.tool_velocity_m_per_s = 1.3 * scene.normal();
    CHECK(scene.tick(9).action == Action::retract);
    scene.seen.tool_velocity_m_per_s.setZero();
    CHECK(scene.tick().action == Action::retract);
  }
}

TEST_CASE("an arm that was told to comply and is braked tells of the disobedience in its action") {
  Scene scene = leaving();
  scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
  scene.tick(50);
  REQUIRE(scene.verdict.action == Action::brake);
  CHECK(scene.verdict.latched);
  scene.seen.tool_velocity_m_per_s.setZero();
  scene.seen.gravity_nm.array() += 0.5;
  CHECK(scene.tick(3).action == Action::brake);
  CHECK(scene.tick(3).allowed_nm == scene.seen.gravity_nm);
}

TEST_CASE("torques that do not move the joints as they should make the arm comply") {
  Scene scene;
  scene.seen.torque_misfit = 1.0;
  scene.seen.weak_joint = 3;
  CHECK(scene.tick(200).action == Action::pass);
  scene.seen.torque_misfit = 1.001;
  scene.seen.weak_joint = -1;
  CHECK(scene.tick().action == Action::comply);
  CHECK(scene.verdict.cause == Cause::torques_amiss);
  CHECK(scene.verdict.latched);
  CHECK(scene.tick(1000).action == Action::comply);  // and it can be pushed away for ever
  CHECK(Observation{}.torque_misfit == 0.0);
  CHECK(Observation{}.weak_joint == -1);
}

TEST_CASE("an arm with one drive to blame is braked; one that presses somebody gives way") {
  const auto blamed = [](Phase phase, double felt_n, int joint) {
    Scene scene;
    scene.proposal.phase = phase;
    scene.force_n = felt_n;
    scene.tick(10);
    scene.seen.torque_misfit = 1.001;
    scene.seen.weak_joint = joint;
    return scene.tick();
  };
  for (const Phase phase : {Phase::free, Phase::approach, Phase::contact, Phase::retract}) {
    for (const int joint : {0, 5}) {
      CHECK(blamed(phase, 4.99, joint).action == Action::brake);
      CHECK(blamed(phase, 4.99, joint).cause == Cause::drive_amiss);
      CHECK(blamed(phase, 4.99, joint).latched);
      CHECK(blamed(phase, 5.01, joint).action == Action::comply);
      CHECK(blamed(phase, 5.01, joint).cause == Cause::torques_amiss);
    }
    CHECK(blamed(phase, 0.0, -1).action == Action::comply);
  }
}

TEST_CASE("no drive is blamed for an arm that was stopped before") {
  Scene scene;
  scene.force_n = 0.0;
  scene.proposal.phase = Phase::free;
  scene.tick(10);
  scene.comply();
  scene.seen.torque_misfit = 2.0;
  scene.seen.weak_joint = 1;
  CHECK(scene.tick(200).action == Action::comply);
}

TEST_CASE("an arm that first goes inward and then races is braked by both together") {
  Scene scene = leaving();
  scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
  scene.tick(3);
  scene.seen.tool_velocity_m_per_s = 1.3 * scene.normal();
  CHECK(scene.tick(9).action == Action::retract);
  CHECK(scene.tick().action == Action::brake);
}
