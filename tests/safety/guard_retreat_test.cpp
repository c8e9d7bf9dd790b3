// SPDX-License-Identifier: Apache-2.0
// The guard's own law: what it does with a tool that is held still, and with one that moves.
#include "tests/safety/point_mass.hpp"
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// A scene in which nothing is felt: the guard has nobody to push away.
Scene free_scene() {
  Scene scene;
  scene.force_n = 0.0;
  scene.tick(10);
  return scene;
}

/// A scene in which a person presses against the tool.
Scene pressed_scene(double force_n = 20.0) {
  Scene scene;
  scene.force_n = force_n;
  scene.tick(10);
  return scene;
}

}  // namespace

TEST_CASE(
    "a frozen tool is held at its place: 800 N/m, at most 5 N inward and 40 N outward, any force "
    "aside") {
  Scene scene = free_scene();
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
  check_same(pulled_from(0.1 * aside), -80.0 * aside);
  check_same(pulled_from(0.1 * aside + 0.02 * scene.normal()),
             -80.0 * aside - 5.0 * scene.normal());
}

TEST_CASE("a new freeze holds the tool where it is then") {
  Scene scene = free_scene();
  scene.freeze();
  CHECK(scene.tick(101).action < Action::freeze);
  scene.seen.tool_in_base.x() += 0.1;
  scene.proposal.virtual_target_in_base.x() += 0.1;
  scene.tick(10);
  scene.freeze();
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE(
    "while the guard acts the tool and the joints are braked, and all but a complying arm keep "
    "their posture") {
  for (const bool complies : {false, true}) {
    Scene scene = free_scene();
    if (complies) scene.comply();
    if (!complies) scene.freeze();
    const Vector3 velocity(0.05, -0.1, 0.02);
    scene.seen.tool_velocity_m_per_s = velocity;
    scene.seen.dq_rad_per_s[3] = 0.5;
    for (int i = 0; i < 10; ++i) scene.seen.q_rad[4] += 4e-3, scene.tick();
    check_same(scene.allowed_n(), -60.0 * velocity);
    const JointVector joints_nm = scene.verdict.allowed_nm - scene.seen.gravity_nm;
    CHECK(joints_nm[3] == doctest::Approx(-0.8 * 0.5).epsilon(1e-9));
    CHECK(joints_nm[4] == doctest::Approx(complies ? 0.0 : -4.0 * 0.04).epsilon(1e-9));
    CHECK(joints_nm[5] == doctest::Approx(0.0));
  }
}

TEST_CASE("a complying arm has no place of its own") {
  Scene scene = free_scene();
  scene.comply();
  scene.seen.tool_in_base += Vector3(0.1, 0.2, -0.3);
  scene.tick(10);
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE("the torques of the guard are ten times as quick as a controller's may be") {
  Scene scene = free_scene();
  scene.freeze();
  const JointVector before_nm = scene.verdict.allowed_nm;
  scene.seen.tool_in_base += 0.1 * scene.normal().unitOrthogonal();
  scene.tick();
  CHECK((scene.verdict.allowed_nm - before_nm).cwiseAbs().maxCoeff() == doctest::Approx(10.0));
}

TEST_CASE("a retreat pulls outward at 0.1 m/s, up to 40 N or 50 mm ahead of the tool") {
  Scene scene = free_scene();
  scene.retract();
  check_same(scene.allowed_n(), 0.08 * scene.normal());
  scene.tick(99);
  check_same(scene.allowed_n(), 8.0 * scene.normal());
  scene.tick(500);
  check_same(scene.allowed_n(), 40.0 * scene.normal());
  scene.seen.tool_in_base += 0.02 * scene.normal();  // so it is 30 mm behind, and the pull goes on
  scene.tick();
  const double before_n = scene.outward_n();
  CHECK(before_n > 24.0);
  CHECK(before_n < 24.2);
  scene.tick();
  CHECK(scene.outward_n() - before_n == doctest::Approx(0.08));
}

TEST_CASE("a retreat goes on until the tool itself has come 60 mm, then it holds") {
  for (const double way_m : {0.0598, 0.0602}) {
    Scene scene = free_scene();
    scene.retract();
    scene.tick(100);
    scene.seen.tool_in_base += way_m * scene.normal();
    scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
    scene.tick();
    const double before_n = scene.outward_n();
    CHECK(before_n == doctest::Approx(-5.0));  // pulled back no harder than that
    scene.tick(1100);
    CHECK(scene.outward_n() == doctest::Approx(way_m < 0.06 ? 40.0 : -5.0));
  }
}

TEST_CASE("after sixty millimetres, to the last bit, the tool is braked however it is pressed") {
  for (const double way_m : {0.06, 0.08}) {
    Scene scene;
    scene.face(Vector3::UnitZ());
    scene.seen.tool_in_base.setZero();
    scene.proposal.virtual_target_in_base.setZero();
    scene.tick(10);
    scene.retract();
    scene.tick(100);
    scene.seen.tool_in_base.z() = way_m;
    scene.seen.tool_velocity_m_per_s.z() = 0.1;
    scene.tick(600);
    CHECK(scene.outward_n() == doctest::Approx(-5.0 - 60.0 * 0.1));
  }
}

TEST_CASE("a retreat that follows a freeze counts its way from where it begins") {
  Scene scene = free_scene();
  scene.freeze();
  scene.seen.tool_in_base += 0.1 * scene.normal();
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.tick();
  scene.retract();
  check_same(scene.allowed_n(), 0.08 * scene.normal());
}

TEST_CASE(
    "more than 5 N felt make a retreat push outward with 80 N, up to a quarter of a metre in a "
    "second") {
  const auto pushed_n = [](double felt_n, double outward_m_per_s) {
    Scene scene = pressed_scene(felt_n);
    scene.face(Vector3::UnitZ());
    scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
    scene.retract();
    scene.seen.tool_velocity_m_per_s = {0.05, 0.0, outward_m_per_s};
    scene.tick(4);
    CHECK(scene.allowed_n().x() == doctest::Approx(-3.0));  // aside it is braked
    CHECK(scene.allowed_n().y() == doctest::Approx(0.0));
    return scene.allowed_n().z();
  };
  const double pull_n = 0.08 * 5;  // of the spring that moves out
  CHECK(pushed_n(5.04, 0.0) == doctest::Approx(80.0));
  CHECK(pushed_n(5.0, 0.0) == doctest::Approx(pull_n));
  CHECK(pushed_n(4.96, 0.0) == doctest::Approx(pull_n));
  CHECK(pushed_n(20.0, -0.2) == doctest::Approx(80.0));
  CHECK(pushed_n(20.0, 0.249) == doctest::Approx(80.0));
  CHECK(pushed_n(20.0, 0.25) == doctest::Approx(pull_n));
  CHECK(pushed_n(20.0, 0.3) == doctest::Approx(pull_n));
  CHECK(pushed_n(0.0, 0.2) == doctest::Approx(pull_n - 60.0 * 0.2));
}

TEST_CASE("the push ends with the force that is felt, two samples after it") {
  Scene scene = pressed_scene();
  scene.retract();
  scene.tick(5);
  CHECK(scene.outward_n() == doctest::Approx(80.0));
  scene.force_n = 0.0;
  scene.tick();
  CHECK(scene.outward_n() == doctest::Approx(80.0));
  scene.tick(3);  // the torque comes down by 10 Nm in each
  CHECK(scene.outward_n() < 1.0);
}

TEST_CASE(
    "a person who follows a tool that is frozen or complies is braked inward only, and not "
    "pushed") {
  for (const bool complies : {false, true}) {
    Scene scene = pressed_scene();
    if (complies) scene.comply();
    if (!complies) scene.freeze();
    scene.seen.tool_velocity_m_per_s = 0.1 * scene.normal();
    scene.tick(5);
    check_same(scene.allowed_n(), Vector3::Zero());
    scene.seen.tool_velocity_m_per_s = -0.1 * scene.normal();
    scene.tick(5);
    check_same(scene.allowed_n(), 6.0 * scene.normal());
  }
}

TEST_CASE("a tool that presses leaves the skin, and stands 60 mm outside") {
  PointMass world;
  world.press(0.3);
  REQUIRE(world.contact_n() == doctest::Approx(20.0).epsilon(0.05));
  world.ask_to_leave();
  double max_force_n = 0.0;
  for (int ms = 0; ms < 200; ++ms)
    world.step(), max_force_n = std::max(max_force_n, world.contact_n());
  CHECK(max_force_n < 20.5);
  CHECK(world.contact_n() == 0.0);
  for (int ms = 0; ms < 3000; ++ms) world.step();
  REQUIRE(world.verdict.action == Action::retract);
  CHECK(world.way_out_m() > 0.055);
  CHECK(world.way_out_m() < 0.075);
  CHECK(std::abs(world.speed_m_per_s) < 1e-3);
}

TEST_CASE(
    "a person who rises by 60 mm is met with less than the push and the speed of leaving need") {
  for (const double rise_m_per_s : {0.05, 0.1, 0.2}) {
    PointMass world;
    world.press(0.3);
    double max_force_n = 0.0;
    for (int ms = 0; ms < 3000; ++ms) {
      world.skin_m = std::min(0.06, 1e-3 * rise_m_per_s * ms);
      world.step();
      max_force_n = std::max(max_force_n, world.contact_n());
    }
    CAPTURE(rise_m_per_s);
    CAPTURE(max_force_n);
    CHECK(max_force_n < 90.0);
    CHECK(world.contact_n() < 6.0);
  }
}

TEST_CASE("a person who goes away from a frozen tool is followed with 5 N at most") {
  PointMass world;
  world.press(0.3);
  world.skip_ticks(4);
  for (int ms = 0; ms < 90; ++ms) {
    world.skin_m = -0.2e-3 * ms;
    world.step();
    REQUIRE(world.verdict.action == Action::freeze);
    CHECK(world.guarded_n() > -5.0 - 60.0 * std::abs(world.speed_m_per_s) - 1e-6);
  }
  CHECK(world.tool_m > world.skin_m);
}

TEST_CASE("a complying tool is pushed away with the force of its brakes") {
  PointMass world;
  world.press(0.3, 8.0);  // lightly: a spring let go at 20 N throws the tool out
  world.jump_encoder();
  for (int ms = 0; ms < 300; ++ms) {
    world.skin_m = 0.06e-3 * ms;  // a person who sits up slowly
    world.step();
  }
  REQUIRE(world.verdict.action == Action::comply);
  CHECK(world.contact_n() < 60.0 * 0.06 + 1.0);
  CHECK(world.way_out_m() > 0.012);
}

TEST_CASE("a controller that turns its normal round after a stop does not turn the retreat") {
  Scene scene = pressed_scene();
  const Vector3 out = scene.normal();
  scene.retract();
  REQUIRE(scene.verdict.latched);
  scene.proposal.normal_in_base = -out;
  scene.tick(200);
  CHECK(scene.allowed_n().dot(out) > 10.0);
}
