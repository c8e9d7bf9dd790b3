// SPDX-License-Identifier: Apache-2.0
// The way out: where it leads, how hard it pushes, and what an arm that does not take it gets.
#include <cmath>

#include "tests/safety/point_mass.hpp"
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE("a retreat pulls outward at 0.1 m/s, up to 40 N or 50 mm ahead of the tool") {
  Scene scene = retreating(0.0);
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
    Scene scene = retreating(0.0);
    scene.tick(99);
    scene.seen.tool_in_base += way_m * scene.normal();
    scene.tick();
    const double before_n = scene.outward_n();
    CHECK(before_n == doctest::Approx(-5.0));  // pulled back no harder than that
    scene.tick(1100);
    CHECK(scene.outward_n() == doctest::Approx(way_m < 0.06 ? 40.0 : -5.0));
  }
}

TEST_CASE("a retreat that follows a freeze counts its way from where it begins") {
  Scene scene;
  scene.force_n = 0.0;
  scene.tick(10);
  scene.freeze();
  scene.seen.tool_in_base += 0.1 * scene.normal();
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.tick();
  scene.retract();
  check_same(scene.allowed_n(), 0.08 * scene.normal());
}

TEST_CASE("more than 5 N out of the body make a retreat push with 80 N, up to 0.8 m/s") {
  const auto pushed_n = [](double felt_n, double outward_m_per_s) {
    Scene scene = retreating(felt_n);
    scene.tick(5);
    scene.seen.tool_velocity_m_per_s = {0.05, 0.0, outward_m_per_s};
    scene.tick(9);  // ten would be a run-away, and be braked
    scene.seen.tool_velocity_m_per_s.z() = outward_m_per_s;
    CHECK(scene.allowed_n().y() == doctest::Approx(0.0));
    return scene.allowed_n();
  };
  const double pull_n = 0.08 * 15;  // of the spring that moves out
  CHECK(pushed_n(5.01, 0.0).z() == doctest::Approx(80.0));
  CHECK(pushed_n(5.0, 0.0).z() == doctest::Approx(pull_n));
  CHECK(pushed_n(20.0, -0.2).z() == doctest::Approx(80.0));
  CHECK(pushed_n(20.0, 0.799).z() == doctest::Approx(80.0));
  CHECK(pushed_n(20.0, 0.8).z() == doctest::Approx(0.0));
  CHECK(pushed_n(20.0, 1.1).z() == doctest::Approx(0.0));
  CHECK(pushed_n(0.0, 0.2).z() == doctest::Approx(pull_n - 60.0 * 0.2));
  // Nothing holds a pressed tool, neither along its way nor aside; a free one is braked.
  CHECK(pushed_n(20.0, 0.3).x() == doctest::Approx(0.0));
  CHECK(pushed_n(0.0, 0.0).x() == doctest::Approx(-3.0));
}

TEST_CASE("while it is pressed a retreat has no end, and holds the tool at no place") {
  Scene scene = retreating(20.0);
  scene.tick(10);
  const Vector3 far = scene.seen.tool_in_base + Vector3(0.25, 0.0, 0.4);
  scene.seen.tool_in_base = far;
  for (int i = 0; i < 50; ++i) scene.seen.q_rad[4] += 0.1e-3, scene.tick();
  check_same(scene.allowed_n(), 80.0 * Vector3::UnitZ());
  CHECK(scene.verdict.allowed_nm[4] == doctest::Approx(scene.seen.gravity_nm[4]));
  scene.seen.dq_rad_per_s[5] = 0.1;  // only its joints are damped a little
  scene.tick();
  CHECK(scene.verdict.allowed_nm[5] == doctest::Approx(scene.seen.gravity_nm[5] - 0.8 * 0.1));
  scene.seen.dq_rad_per_s.setZero();
  // Once the person is gone it leaves where they are by 60 mm, then it holds.
  scene.force_n = 0.0;
  scene.tick(20);
  const double leaving_n = scene.outward_n();
  CHECK(leaving_n > 1.0);
  CHECK(scene.verdict.allowed_nm[4] == doctest::Approx(scene.seen.gravity_nm[4]));
  scene.tick(100);
  check_same(scene.allowed_n(), (leaving_n + 8.0) * Vector3::UnitZ());
  scene.seen.tool_in_base = far + 0.0598 * Vector3::UnitZ();
  scene.tick(1100);
  check_same(scene.allowed_n(), 40.0 * Vector3::UnitZ());
  scene.seen.tool_in_base = far + 0.0602 * Vector3::UnitZ();
  scene.tick(3);
  const double holding_n = scene.outward_n();
  scene.tick(100);
  CHECK(scene.outward_n() == doctest::Approx(holding_n));
}

TEST_CASE("a tool that is pressed as it is stopped has met nobody for 40 ms more") {
  const auto pushed_n = [](int ticks) {
    Scene scene = retreating(20.0);
    scene.tick(ticks);
    scene.seen.tool_in_base += 0.0601 * scene.normal();
    scene.tick();
    return scene.outward_n();
  };
  CHECK(pushed_n(38) < 40.1);
  CHECK(pushed_n(39) == doctest::Approx(80.0));
}

TEST_CASE("a leaving tool that swings, and so feels its own mass, is not pushed on and on") {
  const auto pushed_n = [](int ticks_felt, double flown_m) {
    Scene scene = retreating(20.0);
    scene.tick(60);
    scene.force_n = 0.0;
    scene.tick(20);
    scene.seen.tool_in_base += flown_m * scene.normal();
    scene.tick(10);
    scene.force_n = 20.0;
    scene.tick(1 + ticks_felt);  // one sample is no force yet
    return scene.outward_n();
  };
  CHECK(pushed_n(20, 0.0599) == doctest::Approx(80.0));
  CHECK(pushed_n(20, 0.0601) < 40.1);
  CHECK(pushed_n(40, 0.0601) < 40.1);
  // Who comes after it is felt for longer than a swing.
  CHECK(pushed_n(42, 0.0601) == doctest::Approx(80.0));
  CHECK(pushed_n(42, 0.5) == doctest::Approx(80.0));
}

TEST_CASE("a hand that pushes a leaving tool down, or aside, is not answered with 80 N") {
  for (const Vector3& along : {Vector3(0.0, 0.0, -1.0), Vector3(1.0, 0.0, 0.0)}) {
    Scene scene = retreating(8.0);
    scene.pushed_along = along;
    scene.tick(3);
    check_same(scene.allowed_n(), scene.outward_n() * Vector3::UnitZ());
    CHECK(scene.outward_n() < 1.0);
    scene.tick(100);
    CHECK(scene.outward_n() < 9.0);
    scene.seen.tool_in_base.x() += 0.25;
    scene.tick(10);
    CHECK(scene.allowed_n().x() == doctest::Approx(-40.0));
  }
}

TEST_CASE("what is felt no more ends the push of a retreat, and one sample begins none") {
  Scene gone = retreating(20.0);
  gone.tick(10);
  gone.force_n = 0.0;
  gone.tick();
  CHECK(gone.outward_n() < 40.0);
  // One sample over 5 N is not yet a person.
  Scene blow = retreating(0.0);
  blow.force_n = 20.0;
  blow.tick();
  CHECK(blow.outward_n() < 1.0);
  blow.tick();
  CHECK(blow.outward_n() > 40.0);
}

TEST_CASE(
    "a tool that pressed when its sensor failed leaves by 0.2 m, at up to half a metre a second") {
  Scene scene = retreating(20.0);
  scene.tick(10);
  scene.sensor_alive = false;
  scene.tick(50);
  check_same(scene.allowed_n(), 80.0 * scene.normal());
  scene.seen.tool_velocity_m_per_s = 0.497 * scene.normal() + Vector3(0.1, 0.0, 0.0);
  scene.tick();
  check_same(scene.allowed_n(), 80.0 * scene.normal());
  scene.seen.tool_velocity_m_per_s = 0.503 * scene.normal() + Vector3(0.1, 0.0, 0.0);
  scene.tick(2);  // torques fall by 10 Nm in each
  check_same(scene.allowed_n(), Vector3::Zero());
  scene.seen.tool_velocity_m_per_s.setZero();
  scene.seen.tool_in_base += 0.199 * scene.normal();
  scene.tick(2);
  check_same(scene.allowed_n(), 80.0 * scene.normal());
  scene.seen.tool_in_base += 0.002 * scene.normal();
  scene.tick(2);
  check_same(scene.allowed_n(), Vector3::Zero());
}

TEST_CASE("a tool in the air whose sensor fails is not pushed") {
  for (const double felt_n : {4.9, 5.1}) {
    Scene scene = retreating(felt_n);
    scene.tick(10);
    scene.sensor_alive = false;
    scene.tick(10);
    if (felt_n < 5.0) CHECK(scene.outward_n() < 3.0);
    if (felt_n > 5.0) CHECK(scene.outward_n() == doctest::Approx(80.0));
  }
}

TEST_CASE("where nothing is felt any more nothing holds a tool back that goes outward") {
  const auto outward_n = [](bool alive, double outward_m_per_s) {
    Scene scene = retreating(0.0);
    scene.tick(5);
    scene.sensor_alive = alive;
    scene.tick(6);
    scene.seen.tool_in_base += 0.03 * scene.normal();
    scene.seen.tool_velocity_m_per_s = outward_m_per_s * scene.normal() + Vector3(0.1, 0.0, 0.0);
    scene.tick(5);
    CHECK(scene.allowed_n().x() == doctest::Approx(-60.0 * 0.1));
    return scene.outward_n();
  };
  CHECK(outward_n(true, 0.25) == doctest::Approx(-5.0 - 60.0 * 0.25));
  CHECK(std::abs(outward_n(false, 0.25)) < 1e-9);
  CHECK(outward_n(false, -0.25) == doctest::Approx(60.0 * 0.25));  // nor lets it fall back
}

TEST_CASE("a controller that turns its normal round does not turn the retreat, before or after") {
  for (const bool before : {false, true}) {
    Scene scene;
    const Vector3 out = scene.normal();
    scene.tick(10);
    if (before) scene.proposal.normal_in_base = -out, scene.tick(3);
    scene.proposal.set_force_n = 46.0;
    scene.tick();
    REQUIRE(scene.verdict.latched);
    scene.proposal.normal_in_base = -out;
    scene.tick(200);
    check_same(scene.allowed_n(), 80.0 * out);
  }
}

TEST_CASE("a way out is believed up to 5 N, or where what is felt points along it by a quarter") {
  const auto believed = [](double felt_n, double cosine) {
    Scene scene;
    scene.face(Vector3::UnitZ());
    scene.noise_n = 0.0;
    scene.force_n = felt_n;
    scene.tick(5);
    const Vector3 other(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
    scene.proposal.normal_in_base = other;
    scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
    scene.tick();
    scene.sensor_alive = false;  // so that it pulls along its way
    scene.retract();
    scene.tick(400);
    return (scene.allowed_n() - scene.allowed_n().norm() * other).norm() < 1e-6;
  };
  CHECK(believed(20.0, 0.251));
  CHECK_FALSE(believed(20.0, 0.249));
  CHECK_FALSE(believed(5.0, -1.0));
  CHECK(believed(4.99, -1.0));
  Scene scene;  // what is no direction turns nothing
  scene.tick(5);
  const Vector3 out = scene.normal();
  scene.force_n = 0.0;
  scene.proposal.normal_in_base = {0.0, 0.0, 2.0};
  scene.tick(100);
  check_same(scene.allowed_n(), 8.0 * out);
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

TEST_CASE("a person who sits up by 200 mm is met with less than 90 N, and left") {
  for (const double rise_m_per_s : {0.1, 0.3, 0.5}) {
    PointMass world;
    world.press(0.3);
    double max_force_n = 0.0, rises_m_per_s = 0.0;
    for (int ms = 0; ms < 3000; ++ms) {
      rises_m_per_s = std::min(rise_m_per_s, rises_m_per_s + 10.0 * 1e-3);
      world.skin_m = std::min(0.2, world.skin_m + 1e-3 * rises_m_per_s);
      world.step();
      max_force_n = std::max(max_force_n, world.contact_n());
    }
    CAPTURE(rise_m_per_s);
    CAPTURE(max_force_n);
    CHECK(max_force_n < 90.0);
    CHECK(world.contact_n() < 6.0);
    CHECK(world.verdict.action == Action::retract);
  }
}
