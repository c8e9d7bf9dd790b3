// SPDX-License-Identifier: Apache-2.0
// The guard's own law while it holds a tool in its place, or lets it be pushed away.
#include "tests/safety/point_mass.hpp"
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// A scene in which a person presses against the tool with that force.
Scene felt_scene(double force_n) {
  Scene scene;
  scene.force_n = force_n;
  scene.tick(10);
  return scene;
}

}  // namespace

TEST_CASE(
    "a frozen tool is held at its place: 800 N/m, at most 5 N inward, 40 N outward and 40 N "
    "aside") {
  Scene scene = felt_scene(0.0);
  scene.freeze();
  const Vector3 held = scene.seen.tool_in_base;
  const Vector3 aside = scene.normal().unitOrthogonal();
  check_same(scene.allowed_n(), Vector3::Zero());
  const auto pulled_from = [&](const Vector3& by_m) {
    scene.seen.tool_in_base = held + by_m;
    scene.tick(5);  // until the rate of the torque has let it through
    REQUIRE(scene.verdict.action == Action::freeze);
    return scene.allowed_n();
  };
  check_same(pulled_from(0.005 * scene.normal()), -4.0 * scene.normal());
  check_same(pulled_from(0.01 * scene.normal()), -5.0 * scene.normal());
  check_same(pulled_from(-0.04 * scene.normal()), 32.0 * scene.normal());
  check_same(pulled_from(-0.06 * scene.normal()), 40.0 * scene.normal());
  check_same(pulled_from(0.04 * aside), -32.0 * aside);
  check_same(pulled_from(0.06 * aside), -40.0 * aside);
  check_same(pulled_from(0.25 * aside + 0.02 * scene.normal()),
             -40.0 * aside - 5.0 * scene.normal());
}

TEST_CASE("a new freeze holds the tool where it is then") {
  Scene scene = felt_scene(0.0);
  scene.freeze();
  CHECK(scene.tick(100).action < Action::freeze);
  scene.seen.tool_in_base.x() += 0.1;
  scene.proposal.virtual_target_in_base.x() += 0.1;
  scene.tick(10);
  scene.freeze();
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE("a frozen tool goes on pressing as hard as it did, and no harder than it is felt to") {
  Scene scene = felt_scene(20.0);
  scene.freeze();
  check_same(scene.allowed_n(), -20.0 * scene.normal());
  const auto pressed_n = [&](double felt_n) {
    scene.force_n = felt_n;
    scene.tick(7);
    REQUIRE(scene.verdict.action == Action::freeze);
    check_same(scene.allowed_n(), scene.outward_n() * scene.normal());
    return -scene.outward_n();
  };
  CHECK(pressed_n(12.0) == doctest::Approx(12.0));
  CHECK(pressed_n(21.0) == doctest::Approx(20.0));
  CHECK(pressed_n(30.0) == doctest::Approx(20.0));
  CHECK(pressed_n(4.99) < 1e-9);  // less than 5 N may be anything
  CHECK(pressed_n(13.0) == doctest::Approx(13.0));
  scene.pushed_along = 0.6 * scene.normal() + 0.8 * scene.normal().unitOrthogonal();
  CHECK(pressed_n(20.0) == doctest::Approx(12.0));
}

TEST_CASE("a tool that pressed with less than 5 N when it was frozen presses nobody who comes") {
  Scene scene = felt_scene(4.9);
  scene.freeze();
  scene.force_n = 9.0;
  scene.tick(7);
  REQUIRE(scene.verdict.action == Action::freeze);
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE("an arm that is frozen for want of samples lets go") {
  Scene scene = felt_scene(20.0);
  scene.sensor_alive = false;
  CHECK(scene.tick(4).cause == Cause::force_stale);
  REQUIRE(scene.verdict.action == Action::freeze);
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE("a blow that nobody has judged yet is not what a frozen tool goes on with") {
  Scene scene = felt_scene(20.0);
  scene.force_n = 500.0;
  scene.tick(2);
  scene.miss(3);
  scene.tick();  // the third sample, which is believed, and the freeze
  REQUIRE(scene.verdict.action == Action::freeze);
  check_same(scene.allowed_n(), -20.0 * scene.normal());
}

TEST_CASE(
    "while the guard acts the tool and the joints are braked, and all but a complying arm keep "
    "their posture") {
  for (const bool complies : {false, true}) {
    Scene scene = felt_scene(0.0);
    if (complies) scene.comply();
    if (!complies) scene.freeze();
    const Vector3 velocity(0.05, -0.1, 0.02);
    scene.seen.tool_velocity_m_per_s = velocity;
    for (int i = 0; i < 10; ++i) scene.seen.q_rad[4] += 0.1e-3, scene.tick();
    scene.seen.dq_rad_per_s[3] = 0.5;
    scene.tick();
    check_same(scene.allowed_n(), -60.0 * velocity);
    const JointVector joints_nm = scene.verdict.allowed_nm - scene.seen.gravity_nm;
    const double kept = complies ? 0.0 : 4.0;
    CHECK(joints_nm[3] == doctest::Approx(-0.8 * 0.5 - kept * 0.5e-3).epsilon(1e-9));
    CHECK(joints_nm[4] == doctest::Approx(-kept * 1e-3).epsilon(1e-9));
    CHECK(joints_nm[5] == doctest::Approx(0.0));
  }
}

TEST_CASE("a complying arm has no place of its own") {
  Scene scene = felt_scene(0.0);
  scene.comply();
  scene.seen.tool_in_base += Vector3(0.1, 0.2, -0.3);
  scene.tick(10);
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE("the torques of the guard are ten times as quick as a controller's may be") {
  Scene scene = felt_scene(20.0);
  scene.guard.stop(Action::retract, Cause::asked_to);
  const JointVector before_nm = scene.verdict.allowed_nm;
  scene.tick();
  CHECK((scene.verdict.allowed_nm - before_nm).cwiseAbs().maxCoeff() == doctest::Approx(10.0));
}

TEST_CASE("a person who follows a complying tool is braked inward only, and not pushed") {
  Scene scene = felt_scene(20.0);
  scene.comply();
  scene.seen.tool_velocity_m_per_s = 0.1 * scene.normal();
  scene.tick(5);
  check_same(scene.allowed_n(), Vector3::Zero());
  scene.seen.tool_velocity_m_per_s = -0.1 * scene.normal();
  scene.tick(5);
  check_same(scene.allowed_n(), 6.0 * scene.normal());
  scene.force_n = 0.0;  // with nobody there the way out is braked too
  scene.seen.tool_velocity_m_per_s = 0.1 * scene.normal();
  scene.tick(5);
  check_same(scene.allowed_n(), -6.0 * scene.normal());
}

TEST_CASE("a person who keeps still does not feel a freeze, whoever leaves is not chased") {
  for (const double leaving_m_per_s : {0.0, 0.1}) {
    PointMass world;
    world.press(0.3);
    double min_n = 20.0, max_n = 20.0;
    world.skip_ticks(4);
    for (int ms = 0; ms < 95; ++ms) {
      world.skin_m = -1e-3 * leaving_m_per_s * ms;
      world.step();
      REQUIRE(world.verdict.action == Action::freeze);
      min_n = std::min(min_n, world.contact_n()), max_n = std::max(max_n, world.contact_n());
    }
    CHECK(max_n < 20.5);
    CHECK(world.speed_m_per_s > -0.1);
    if (leaving_m_per_s == 0.0) CHECK(min_n > 19.0);
  }
}

TEST_CASE("a complying tool is pushed away with the force of its brakes") {
  PointMass world;
  world.press(0.3, 8.0);  // lightly: a spring let go at 20 N throws the tool out
  world.comply();
  for (int ms = 0; ms < 300; ++ms) {
    world.skin_m = 0.06e-3 * ms;  // a person who sits up slowly
    world.step();
  }
  REQUIRE(world.verdict.action == Action::comply);
  CHECK(world.contact_n() < 60.0 * 0.06 + 1.0);
  CHECK(world.way_out_m() > 0.012);
}

TEST_CASE("a tool that was frozen in the air does not press who comes then") {
  Scene scene = felt_scene(0.0);
  scene.freeze();
  for (; scene.force_n < 20.0; scene.force_n += 1.0) scene.tick();
  REQUIRE(scene.verdict.action == Action::freeze);
  check_same(scene.allowed_n(), Vector3::Zero());
}
