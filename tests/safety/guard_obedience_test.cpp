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

TEST_CASE("an arm that leaves and presses harder and harder, going inward, is braked in 3 ms") {
  const auto digging = [](double gentlest_n, double n, double inward_m_per_s, int ticks) {
    Scene scene = leaving(gentlest_n);
    scene.tick(2);  // the median of three
    scene.seen.tool_velocity_m_per_s = -inward_m_per_s * scene.normal();
    scene.force_n = n;
    scene.tick(1);  // likewise
    return scene.tick(ticks).action;
  };
  CHECK(digging(30.0, 45.1, 0.0501, 2) == Action::retract);
  CHECK(digging(30.0, 45.1, 0.0501, 3) == Action::brake);
  CHECK(digging(30.0, 44.9, 0.0501, 30) == Action::retract);
  CHECK(digging(30.0, 45.1, 0.0499, 30) == Action::retract);
  CHECK(digging(30.0, 45.1, -0.2, 30) == Action::retract);  // a person who comes closer
  CHECK(digging(20.0, 39.9, 0.0501, 30) == Action::retract);
  CHECK(digging(20.0, 40.1, 0.0501, 3) == Action::brake);
  CHECK(digging(35.0, 50.1, 0.0501, 3) == Action::brake);
}

TEST_CASE("what was felt before an arm leaves is not its gentlest") {
  Scene scene;
  scene.force_n = 10.0;
  scene.tick(10);
  scene.force_n = 30.0;
  scene.tick(10);
  scene.retract();
  scene.tick(2);
  scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
  scene.force_n = 42.0;
  CHECK(scene.tick(30).action == Action::retract);
}

TEST_CASE("an arm under the guard that plunges into the body is braked in 3 ms") {
  const auto plunging = [](Action action, double inward_m_per_s, int ticks) {
    Scene scene;
    scene.force_n = 0.0;
    scene.proposal.phase = Phase::free;
    scene.tick(10);
    scene.guard.stop(action, Cause::arms_too_close);
    scene.tick();
    scene.seen.tool_velocity_m_per_s = -inward_m_per_s * scene.normal();
    return scene.tick(ticks).action;
  };
  for (const Action action : {Action::comply, Action::retract}) {
    CHECK(plunging(action, 0.301, 2) == action);
    CHECK(plunging(action, 0.301, 3) == Action::brake);
    CHECK(plunging(action, 0.299, 100) == action);
    CHECK(plunging(action, -0.5, 100) == action);
  }
  // Likewise one that races aside besides.
  for (const double aside_m_per_s : {1.1, 1.3, 3.0}) {
    Scene scene;
    scene.force_n = 0.0;
    scene.proposal.phase = Phase::free;
    scene.tick(10);
    scene.guard.stop(Action::retract, Cause::arms_too_close);
    scene.tick();
    scene.seen.tool_velocity_m_per_s =
        aside_m_per_s * scene.normal().unitOrthogonal() - 0.301 * scene.normal();
    CHECK(scene.tick(2).action == Action::retract);
    CHECK(scene.tick().action == Action::brake);
  }
  // One that is free is stopped by its speed first.
  CHECK(plunging(Action::pass, 0.35, 3) == Action::comply);
  CHECK(plunging(Action::pass, 0.35, 5) == Action::comply);
  CHECK(plunging(Action::pass, 0.35, 6) == Action::brake);
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
  const auto racing = [](Action action, double m_per_s, int ticks, double outward = 0.0) {
    Scene scene;
    scene.force_n = 0.0;
    scene.proposal.phase = Phase::free;
    scene.tick(10);
    scene.guard.stop(action, Cause::arms_too_close);
    scene.tick();
    scene.seen.tool_velocity_m_per_s =
        m_per_s * scene.normal().unitOrthogonal() + outward * scene.normal();
    return scene.tick(ticks).action;
  };
  for (const Action action : {Action::comply, Action::retract}) {
    CHECK(racing(action, 1.201, 9) == action);
    CHECK(racing(action, 1.201, 10) == Action::brake);
    CHECK(racing(action, 1.199, 100) == action);
    CHECK(racing(action, -1.201, 10) == Action::brake);
    CHECK(racing(action, 0.0, 10, -1.201) == Action::brake);
    // Outward it was thrown by somebody who may come after it.
    CHECK(racing(action, 0.0, 100, 2.395) == action);
    CHECK(racing(action, 0.0, 10, 2.405) == Action::brake);
    CHECK(racing(action, 1.195, 100, 1.195) == action);
    CHECK(racing(action, 1.205, 10, 1.195) == Action::brake);
    CHECK(racing(action, 0.5, 10, 2.4) == Action::brake);
  }
  // One that is frozen or free is stopped by its speed first.
  for (const Action action : {Action::pass, Action::freeze}) {
    CHECK(racing(action, 1.201, 12) == Action::comply);
    CHECK(racing(action, 1.201, 13) == Action::brake);
  }
  Scene scene = leaving();
  for (int i = 0; i < 5; ++i) {
    scene.seen.tool_velocity_m_per_s = 1.3 * scene.normal().unitOrthogonal();
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

TEST_CASE("a drive is blamed in the first millisecond too") {
  Scene scene;
  scene.force_n = 0.0;
  scene.seen.torque_misfit = 2.0;
  scene.seen.weak_joint = 1;
  CHECK(scene.tick().action == Action::brake);
}

TEST_CASE("of an arm that was stopped before a drive is blamed after 5 ms on its way to the body") {
  Scene scene;
  scene.force_n = 0.0;
  scene.proposal.phase = Phase::free;
  scene.tick(10);
  scene.comply();
  const auto go = [&](double outward_m_per_s, int weak_joint = 1, double misfit = 2.0) {
    scene.seen.tool_velocity_m_per_s = outward_m_per_s * scene.normal();
    scene.seen.weak_joint = weak_joint;
    scene.seen.torque_misfit = misfit;
  };
  for (int i = 0; i < 4; ++i) {  // it must last
    go(-0.06);
    CHECK(scene.tick(5).action == Action::comply);
    if (i == 3) break;
    go(i == 0 ? -0.0499 : -0.06, i == 1 ? -1 : 1, i == 2 ? 0.9 : 2.0);
    CHECK(scene.tick().action == Action::comply);
  }
  for (const double outward_m_per_s : {-0.0499, 0.0, 0.5}) {
    go(outward_m_per_s);
    CHECK(scene.tick(200).action == Action::comply);
  }
  go(-0.0501);
  scene.force_n = 6.0;
  CHECK(scene.tick(200).action == Action::comply);
  scene.force_n = 0.0;
  CHECK(scene.tick(6).action == Action::comply);  // the median of three is a tick late
  CHECK(scene.tick().action == Action::brake);
  CHECK(scene.verdict.cause == Cause::tool_too_fast);  // the first cause stays
}

TEST_CASE("a tool that flies off faster than any order may be followed, and is not braked") {
  for (const double outward_m_per_s : {0.349, 0.351}) {
    Scene scene;
    scene.force_n = 0.0;
    scene.tick(10);
    scene.seen.tool_velocity_m_per_s = outward_m_per_s * scene.normal();
    scene.seen.torque_misfit = 2.0;
    scene.seen.weak_joint = 1;
    const bool flies = outward_m_per_s > 0.35;
    CHECK(scene.tick().action == (flies ? Action::comply : Action::brake));
    CHECK(scene.verdict.cause == (flies ? Cause::torques_amiss : Cause::drive_amiss));
  }
}

TEST_CASE("who has no living sensor cannot know that nobody is pressed, and brakes for no drive") {
  for (const bool stuck : {false, true}) {
    Scene scene;
    scene.force_n = 0.0;
    scene.tick(10);
    if (stuck) scene.seen.wrist_repeats = 20;
    scene.sensor_alive = stuck;
    scene.tick(10);
    REQUIRE(scene.verdict.action == Action::retract);
    scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
    scene.seen.torque_misfit = 2.0;
    scene.seen.weak_joint = 1;
    CHECK(scene.tick(200).action == Action::retract);
  }
}

TEST_CASE("an arm that first goes inward and then races is braked by both together") {
  Scene scene = leaving();
  scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
  scene.tick(3);
  scene.seen.tool_velocity_m_per_s = 1.3 * scene.normal().unitOrthogonal();
  CHECK(scene.tick(9).action == Action::retract);
  CHECK(scene.tick().action == Action::brake);
}
