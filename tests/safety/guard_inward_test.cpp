// SPDX-License-Identifier: Apache-2.0
// How hard the torques would press, whatever the controller says of them.
#include <algorithm>
#include <cmath>

#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// A scene whose controller has been pushing its tool inward with a force for a while, 5 N felt.
Scene pushing(double inward_n, Phase phase = Phase::contact, Zone zone = Zone::muscle,
              int ticks = 50) {
  Scene scene;
  scene.proposal.zone = zone;
  scene.proposal.set_force_n = ceiling_of(zone).set_n;
  scene.force_n = 5.0;
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.tick(3);
  scene.proposal.phase = phase;
  scene.lean(-inward_n * scene.normal());
  scene.tick(ticks);
  return scene;
}

/// The body comes to press with so much, 1 N a tick.
void come_to(Scene& scene, double felt_n) {
  while (scene.force_n != felt_n) {
    scene.force_n += std::clamp(felt_n - scene.force_n, -1.0, 1.0);
    scene.tick();
  }
  scene.tick(5);
  REQUIRE(scene.verdict.action == Action::pass);
}

/// The hardest push that a scene lets through, asked for 200 N.
double hardest_n(Scene scene) {
  double max_n = 0.0;
  for (double asked_n = -scene.outward_n(); asked_n < 100.0; asked_n += 4.0) {
    scene.pull(-asked_n * scene.normal());
    scene.tick();
    max_n = std::max(max_n, -scene.outward_n());
  }
  return max_n;
}

}  // namespace

TEST_CASE(
    "torques may press 20 N harder than is asked for, 10 N than the trip, 60 N where nobody "
    "presses") {
  for (std::size_t zone = 0; zone < zones; ++zone) {
    for (int phase = 0; phase < 4; ++phase) {
      CAPTURE(zone);
      CAPTURE(phase);
      const double set_n = force_ceilings[zone].set_n;
      const double may_n = std::min(set_n + 20.0, force_ceilings[zone].trip_n + 10.0);
      const bool bench = static_cast<Zone>(zone) == Zone::bench;
      const double in_contact_n = bench ? 100.0 : may_n - 2.0 * std::max(5.0 - set_n, 0.0);
      const std::array<double, 4> limits_n = {60.0, in_contact_n, in_contact_n, 20.0};
      const double limit_n = limits_n[static_cast<std::size_t>(phase)];
      const auto at = [&](double inward_n) {
        return pushing(inward_n, static_cast<Phase>(phase), static_cast<Zone>(zone));
      };
      CHECK(at(limit_n - 0.01).verdict.action == Action::pass);
      Scene over = at(limit_n + 1.0);
      CHECK(over.verdict.action == Action::warn);
      CHECK(over.verdict.cause == Cause::inward_force);
      CHECK_FALSE(over.verdict.latched);
      check_same(over.allowed_n(), -limit_n * over.normal());
    }
  }
}

TEST_CASE("each newton felt beyond what is asked for takes two from what torques may press") {
  for (const double set_n : {0.0, 10.0, 30.0}) {
    for (const double felt_n : {0.0, 9.0, 20.0, 31.0, 44.0}) {
      CAPTURE(set_n);
      CAPTURE(felt_n);
      Scene scene = pushing(0.0);
      scene.proposal.set_force_n = set_n;
      come_to(scene, felt_n);
      const double limit_n = set_n + 20.0 - 2.0 * std::max(felt_n - set_n, 0.0);
      CHECK(hardest_n(scene) == doctest::Approx(std::max(limit_n, 0.0)).epsilon(1e-6));
    }
  }
}

TEST_CASE("a hand that leads an arm may press as hard as the place bears, whatever is felt") {
  Scene scene = pushing(0.0, Phase::contact, Zone::bony);
  scene.proposal.stiffness_n_per_m = 0.0;
  scene.proposal.set_force_n = 0.0;
  come_to(scene, 20.0);
  CHECK(hardest_n(scene) == doctest::Approx(35.0));
}

TEST_CASE("less than nothing is not asked for") {
  for (const double set_n : {-20.0, -infinity}) {
    Scene scene = pushing(0.0);
    scene.proposal.set_force_n = set_n;
    CHECK(hardest_n(scene) == doctest::Approx(20.0 - 2.0 * 5.0));
  }
}

TEST_CASE(
    "on the way out torques press by 20 N, or 3 N harder than the least that was felt since") {
  Scene scene = pushing(0.0);
  come_to(scene, 30.0);
  scene.proposal.phase = Phase::retract;
  scene.tick(10);
  CHECK(hardest_n(scene) == doctest::Approx(33.0));
  come_to(scene, 18.0);
  come_to(scene, 30.0);
  CHECK(hardest_n(scene) == doctest::Approx(21.0));
  come_to(scene, 12.0);
  come_to(scene, 30.0);
  CHECK(hardest_n(scene) == doctest::Approx(20.0));
  scene.proposal.phase = Phase::contact;  // the next contact forgets it
  scene.tick(5);
  scene.proposal.phase = Phase::retract;
  CHECK(hardest_n(scene) == doctest::Approx(33.0));
  scene.proposal.phase = Phase::contact;
  come_to(scene, 58.0);
  scene.proposal.phase = Phase::retract;
  CHECK(hardest_n(scene) == doctest::Approx(60.0));
}

TEST_CASE("pressing too hard is clamped at once, and for a tenth of a second ends the contact") {
  Scene scene = pushing(60.0);
  scene.pull(-89.0 * scene.normal());
  CHECK(scene.tick(99).action == Action::warn);
  check_same(scene.allowed_n(), -65.0 * scene.normal());
  Scene pause = scene;
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::inward_force);
  CHECK(scene.verdict.latched);
  pause.pull(-60.0 * pause.normal());
  CHECK(pause.tick().cause != Cause::inward_force);
  pause.pull(-89.0 * pause.normal());
  CHECK(pause.tick(99).action == Action::warn);
  CHECK(pause.tick().action == Action::retract);
}

TEST_CASE("what presses 30 N harder from one millisecond to the next is not let through") {
  for (const double by_n : {29.9, 30.1}) {
    Scene scene = pushing(10.0);
    scene.pull(-(10.0 + by_n) * scene.normal());
    CHECK(scene.tick().action == (by_n < 30.0 ? Action::warn : Action::freeze));
    if (by_n < 30.0) continue;
    CHECK(scene.verdict.cause == Cause::inward_force);
    CHECK(scene.tick(50).action == Action::freeze);
    CHECK(-scene.outward_n() < 10.0);
    scene.pull(-10.0 * scene.normal());
    CHECK(scene.tick(20).action == Action::pass);
  }
}

TEST_CASE("a tool that a person meets, or that leaves, is not held for a push that begins") {
  const auto pushed = [](Scene scene) {
    scene.pull(-42.0 * scene.normal());
    return scene.tick().action;
  };
  for (const double set_n : {20.0, 0.0, -20.0}) {
    for (const double over_n : {2.9, 3.1}) {
      Scene scene = pushing(10.0);
      scene.proposal.set_force_n = set_n;
      come_to(scene, 5.0);
      scene.pull(Vector3::Zero());
      come_to(scene, std::max(set_n, 0.0) + over_n);
      scene.lean(-10.0 * scene.normal());
      CHECK(pushed(scene) == (over_n < 3.0 ? Action::freeze : Action::warn));
    }
  }
  Scene leaves = pushing(10.0);
  leaves.proposal.phase = Phase::retract;
  CHECK(pushed(leaves) == Action::warn);
  Scene wild = pushing(-40.0);
  wild.proposal.torque_nm[3] = not_a_number;
  CHECK(wild.tick().action == Action::warn);
}

TEST_CASE("a sound arm of much friction, which wants 5 N more than it may, goes on") {
  for (const double beyond_n : {4.98, 5.02}) {
    Scene scene = pushing(65.0 + beyond_n, Phase::contact, Zone::muscle, 200);
    CHECK(scene.verdict.action == (beyond_n < 5.0 ? Action::warn : Action::retract));
    if (beyond_n < 5.0) check_same(scene.allowed_n(), -65.0 * scene.normal());
  }
}

TEST_CASE("130 N inward behind springs of no stiffness, or along the skin, are not let through") {
  for (const bool along_skin : {false, true}) {
    Scene scene = pushing(0.0);
    scene.proposal.stiffness_n_per_m = along_skin ? 1000.0 : 0.0;
    if (along_skin)
      scene.proposal.virtual_target_in_base =
          scene.seen.tool_in_base + scene.normal().unitOrthogonal();
    scene.pull(-130.0 * scene.normal());
    double max_n = 0.0;
    for (int i = 0; i < 100; ++i) scene.tick(), max_n = std::max(max_n, -scene.outward_n());
    CHECK(max_n < 70.001);
    CHECK(scene.verdict.action == Action::retract);
  }
}

TEST_CASE("a push aside or outward, however hard, presses nobody") {
  Scene scene = pushing(0.0);
  scene.pull(150.0 * scene.normal());
  CHECK(scene.tick(150).cause != Cause::inward_force);
  CHECK(scene.verdict.action == Action::pass);
  Scene aside = pushing(0.0);
  aside.pull(150.0 * aside.normal().unitOrthogonal());
  CHECK(aside.tick(150).action == Action::pass);
}

TEST_CASE("a heavy joint presses less with its torque than a light one") {
  // The body holds the tool still: what it must push back is torque that would speed the tool up.
  Scene scene;
  scene.face(Vector3(1.0, 1.0, 0.0).normalized());
  scene.proposal.set_force_n = 45.0;
  scene.force_n = 0.0;
  scene.seen.mass_kg_m2 = JointMatrix::Identity(6, 6);
  scene.seen.mass_kg_m2(0, 0) = 0.25;
  scene.tick(3);
  // By hand: 4 Nm on the light joint count 4, the mobility is 0.2^2 (4 + 1) / 2.
  scene.proposal.torque_nm = scene.seen.gravity_nm;
  for (int half = 0; half < 2; ++half) {
    scene.proposal.torque_nm[0] -= 5.0;
    scene.tick(25);
  }
  const double implied_n = 0.2 * 4.0 * 10.0 / std::sqrt(2.0) / (0.2 * 0.2 * 2.5);
  REQUIRE(implied_n == doctest::Approx(56.57).epsilon(1e-3));
  CHECK(scene.tick().action == Action::pass);
  scene.proposal.torque_nm[0] -= 1.4;
  CHECK(scene.tick(3).action == Action::pass);  // 64.5 N
  scene.proposal.torque_nm[0] -= 0.2;
  CHECK(scene.tick().cause == Cause::inward_force);  // 65.6 N
}

TEST_CASE("joints that reach their torques one after the other press no harder on the way") {
  for (const double second_nm : {30.0, 200.0}) {  // which a drive can give, or cannot
    Scene scene;
    scene.face(Vector3(1.0, 1.0, 0.0).normalized());
    scene.proposal.set_force_n = 45.0;
    scene.seen.gravity_nm.setZero(6);
    scene.proposal.torque_nm.setZero(6);
    scene.seen.jacobian(1, 1) = 0.05;
    scene.tick(3);
    const Vector3 lever = 0.5 * std::sqrt(2.0) * Vector3(0.2, 0.05, 0.0);
    const auto implied_n = [&](const JointVector& torque_nm) {
      return -lever.dot(torque_nm.head<3>()) / lever.squaredNorm();
    };
    JointVector wanted_nm = scene.proposal.torque_nm;
    wanted_nm[0] = second_nm > 50.0 ? -40.0 : -16.0;
    wanted_nm[1] = second_nm;
    REQUIRE(implied_n(wanted_nm) < 64.0);
    double max_n = 0.0;
    JointVector before_nm = scene.verdict.allowed_nm;
    bool warned = false;
    for (int i = 0; i < 180; ++i) {
      scene.proposal.torque_nm = wanted_nm * (i / 60 + 1) / 3.0;
      scene.tick();
      warned = warned || scene.verdict.cause != Cause::none;
      max_n = std::max(max_n, implied_n(scene.verdict.allowed_nm));
      CHECK((scene.verdict.allowed_nm - before_nm).cwiseAbs().maxCoeff() <= 10.0 + 1e-9);
      before_nm = scene.verdict.allowed_nm;
    }
    CHECK(warned);
    CHECK(max_n > 60.0);
    CHECK(max_n < (second_nm > 50.0 ? 66.0 : 65.001));  // a drive at its limit cannot help
  }
}

TEST_CASE("a tool that no joint moves presses nobody") {
  Scene scene;
  scene.seen.jacobian.setZero();
  scene.proposal.torque_nm[0] -= 40.0;
  CHECK(scene.tick(200).cause == Cause::none);
}

TEST_CASE("joints that reach harmless torques one after the other are clamped on the way") {
  Scene scene;
  const Vector3 normal(0.8, 0.6, 0.0);
  scene.face(normal);
  scene.proposal.set_force_n = 45.0;
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.tick(3);
  scene.lean(-64.9 * normal);
  REQUIRE(scene.tick(50).action == Action::pass);
  // The first joint may turn inward at once, the second needs five ticks for its way outward.
  scene.proposal.torque_nm[0] -= 0.99;
  scene.proposal.torque_nm[1] += 5.0;
  scene.proposal.torque_nm[5] += 1e-3;
  scene.tick();
  CHECK(scene.verdict.action == Action::warn);
  CHECK(scene.verdict.cause == Cause::torque_rate_clamped);
  CHECK(-scene.outward_n() < 65.0 + 1e-9);
}
