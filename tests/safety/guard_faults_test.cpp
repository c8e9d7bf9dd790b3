// SPDX-License-Identifier: Apache-2.0
// Ticks, clocks and states that are broken.
#include "tests/allocation.hpp"
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE(
    "one or two missed ticks warn, three to nine freeze for a hundred ticks, ten end the contact") {
  for (int missed = 1; missed <= 10; ++missed) {
    Scene scene;
    scene.tick(10);
    scene.miss(missed);
    scene.proposal.torque_nm[5] += 0.5;
    scene.tick();
    CHECK((scene.verdict.allowed_nm == scene.proposal.torque_nm) == (missed < 3));
    CHECK(scene.verdict.cause == Cause::late_tick);
    CHECK(scene.verdict.action == (missed < 3    ? Action::warn
                                   : missed < 10 ? Action::freeze
                                                 : Action::retract));
    CHECK(scene.verdict.latched == (missed == 10));
    CHECK(scene.tick().action == (missed < 3    ? Action::pass
                                  : missed < 10 ? Action::freeze
                                                : Action::retract));
  }
  Scene scene;
  scene.tick(10);
  scene.freeze();
  CHECK(scene.tick(99).action == Action::freeze);
  CHECK(scene.verdict.cause == Cause::late_tick);
  CHECK(scene.tick().action == Action::pass);
  scene.freeze();
  scene.tick(90);
  scene.miss(2);  // what is missed counts
  CHECK(scene.tick(7).action == Action::freeze);
  CHECK(scene.tick().action == Action::pass);
}

TEST_CASE("a tick that is seen three times again ends the contact, fewer warn") {
  Scene scene;
  scene.tick(100);
  for (int burst = 0; burst < 3; ++burst) {
    for (int again = 0; again < 2; ++again) {
      scene.seen.tick -= 1;
      CHECK(scene.tick_at(scene.seen.time_s).action == Action::warn);
      CHECK(scene.verdict.cause == Cause::late_tick);
      CHECK_FALSE(scene.verdict.latched);
    }
    CHECK(scene.tick().action == Action::pass);
  }
  for (int again = 0; again < 3; ++again) scene.seen.tick -= 1, scene.tick_at(scene.seen.time_s);
  CHECK(scene.verdict.action == Action::retract);
  CHECK(scene.verdict.cause == Cause::late_tick);
  CHECK(scene.verdict.latched);
}

TEST_CASE("readings of which every second one comes twice end the contact with the fifth") {
  Scene scene;
  scene.tick(100);
  for (int ms = 0; ms < 5; ++ms) {
    if (ms % 2 == 0) scene.seen.tick -= 1, scene.tick_at(scene.seen.time_s);
    if (ms % 2 == 1) scene.miss(1), scene.tick();
    CHECK(scene.verdict.action == (ms < 4 ? Action::warn : Action::retract));
    CHECK(scene.verdict.cause == Cause::late_tick);
  }
  Scene overrun;  // who misses every second tick is late, and no more
  for (int ms = 0; ms < 100; ++ms) overrun.miss(1), overrun.tick();
  CHECK(overrun.verdict.action == Action::warn);
}

TEST_CASE("ticks that run backwards end the contact") {
  Scene scene;
  scene.tick(100);
  scene.seen.tick -= 5;
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::late_tick);
}

TEST_CASE("a clock that is off by more than half of what the ticks say three times is broken") {
  const auto paced = [](double ms, int missed, int times) {
    Scene scene;
    scene.tick(100);
    for (int i = 0; i < times; ++i) {
      scene.seen.tick += static_cast<std::uint64_t>(missed);
      scene.tick_at(scene.seen.time_s + 1e-3 * ms);
    }
    return scene.verdict;
  };
  for (const double ms : {0.49, 1.51, -1.0, 3.6e6}) {
    CHECK(paced(ms, 0, 2).action <= Action::warn);
    CHECK(paced(ms, 0, 3).action == Action::retract);
    CHECK(paced(ms, 0, 3).cause == Cause::clock);
    CHECK(paced(ms, 0, 3).latched);
  }
  for (const double ms : {0.51, 1.49}) CHECK(paced(ms, 0, 100).action == Action::pass);
  for (const double ms : {1.51, 4.49}) CHECK(paced(ms, 2, 3).action == Action::warn);
  for (const double ms : {1.49, 4.51}) CHECK(paced(ms, 2, 3).cause == Cause::clock);
  Scene repeated;
  repeated.tick(100);
  for (int i = 0; i < 100; ++i) {  // a tick that is seen again has no time to be late by
    repeated.seen.tick -= 1;
    repeated.tick_at(repeated.seen.time_s + 0.49e-3);
    REQUIRE(repeated.verdict.action == Action::warn);
    REQUIRE(repeated.tick_at(repeated.seen.time_s + 0.51e-3).action == Action::pass);
  }
}

TEST_CASE("somebody may set the clock, forwards or backwards, now and then") {
  for (const double by_s : {3600.0, -3600.0}) {
    Scene scene;
    for (int times = 0; times < 5; ++times) {
      scene.tick(50);
      for (int twice = 0; twice < 2; ++twice) {
        scene.seen.time_s += by_s;
        CHECK(scene.tick().action == Action::pass);
      }
    }
    // Samples go on to be new ones by their stamps: a jump is seen in the tick it happens.
    scene.tick(10);
    scene.seen.time_s += by_s;
    scene.force_n = 500.0;
    CHECK(scene.tick().cause == Cause::force_spike);
  }
}

TEST_CASE("a clock that is set back by an hour does not make a freeze last that long") {
  Scene scene;
  scene.tick(10);
  scene.freeze();
  scene.seen.time_s -= 3600.0;
  CHECK(scene.tick(99).action == Action::freeze);
  CHECK(scene.tick().action == Action::pass);
}

TEST_CASE("a guard may begin at any tick and any time") {
  Scene scene;
  scene.seen.tick = 123456;
  CHECK(scene.tick_at(-50.0).action == Action::pass);
}

TEST_CASE(
    "a state that is not finite or of other joints leaves only the brakes, with the last known "
    "gravity") {
  const std::vector<void (*)(Observation&)> faults = {
      [](Observation& seen) { seen.q_rad[3] = not_a_number; },
      [](Observation& seen) { seen.dq_rad_per_s[0] = infinity; },
      [](Observation& seen) { seen.jacobian(1, 1) = not_a_number; },
      [](Observation& seen) { seen.gravity_nm[5] = not_a_number; },
      [](Observation& seen) { seen.tool_in_base.x() = not_a_number; },
      [](Observation& seen) { seen.tool_velocity_m_per_s.z() = -infinity; },
      [](Observation& seen) { seen.time_s = not_a_number; },
      [](Observation& seen) { seen.q_rad.setZero(5); },
      [](Observation& seen) { seen.q_rad.setZero(7); },
      [](Observation& seen) { seen.dq_rad_per_s.setZero(5); },
      [](Observation& seen) { seen.dq_rad_per_s.setZero(7); },
      [](Observation& seen) { seen.gravity_nm.setZero(5); },
      [](Observation& seen) { seen.gravity_nm.setZero(7); },
      [](Observation& seen) { seen.jacobian.setZero(3, 5); },
      [](Observation& seen) { seen.jacobian.setZero(3, 7); },
      [](Observation& seen) { seen.mass_kg_m2(2, 3) = not_a_number; },
      [](Observation& seen) { seen.mass_kg_m2.setIdentity(5, 6); },
      [](Observation& seen) { seen.mass_kg_m2.setIdentity(6, 5); },
      [](Observation& seen) { seen.mass_kg_m2.setIdentity(7, 6); },
      [](Observation& seen) { seen.mass_kg_m2.setIdentity(6, 7); }};
  for (const auto& spoil : faults) {
    for (const bool wound_up : {false, true}) {
      Scene scene;
      scene.force_n = 0.0;
      scene.tick(10);
      if (wound_up) scene.retract();
      scene.seen.gravity_nm.array() += 0.5;
      scene.tick();
      const JointVector gravity_nm = scene.seen.gravity_nm;
      const Observation whole = scene.seen;
      spoil(scene.seen);
      for (int i = 0; i < 3; ++i) {  // the torque comes down by 10 Nm in each
        scene.seen.tick += 1;
        scene.verdict = scene.guard.check(scene.seen, scene.proposal);
      }
      CHECK(scene.verdict.action == Action::brake);
      CHECK(scene.verdict.latched);
      CHECK(scene.verdict.allowed_nm == gravity_nm);
      CHECK(scene.verdict.cause ==
            (wound_up ? Cause::set_force_too_high : Cause::state_not_finite));
      // Once the joints are known again the brakes stay, and their gravity follows the arm by a
      // tick.
      scene.seen = whole;
      scene.seen.tick += 3;
      scene.seen.gravity_nm.array() -= 1.0;
      scene.tick(2);
      CHECK(scene.verdict.action == Action::brake);
      CHECK(scene.verdict.allowed_nm == scene.seen.gravity_nm);
    }
  }
}

TEST_CASE("a guard of no joints brakes, whatever it sees") {
  Guard guard{Guard::Options{}};
  CHECK(guard.check({}, {}).action == Action::brake);
  CHECK(guard.check({}, {}).allowed_nm.size() == 0);
}

TEST_CASE("a guard that begins in the middle of a fault counts from nothing") {
  const std::vector<void (*)(Scene&)> faults = {
      [](Scene& s) { s.seen.dq_rad_per_s[0] = 4.0; },
      [](Scene& s) { s.seen.tool_velocity_m_per_s.x() = -0.3; },
      [](Scene& s) {
        s.seen.tool_velocity_m_per_s = 0.13 * s.normal();
        s.proposal.set_force_n = 5.0;
      },
      [](Scene& s) { s.proposal.torque_nm[3] = infinity; }};
  for (const auto& spoil : faults) {
    Scene scene;
    spoil(scene);
    CHECK(scene.ticks_until_it_acts() == 2);
  }
  Scene turned;  // the first two samples are not judged
  turned.face(Vector3::UnitZ());
  turned.pushed_along = -Vector3::UnitZ();
  CHECK(turned.ticks_until_it_acts() == 11);
  Scene set;  // the clock of a guard begins with its first tick
  set.seen.time_s = 100.0;
  set.tick();
  for (const double at_s : {300.0, 600.0}) CHECK(set.tick_at(at_s).action == Action::pass);
  CHECK(set.tick_at(900.0).cause == Cause::clock);
  Scene racing;
  racing.guard.stop(Action::comply, Cause::arms_too_close);
  racing.seen.tool_velocity_m_per_s.x() = 1.3;
  CHECK(racing.tick(9).action == Action::comply);
  CHECK(racing.tick().action == Action::brake);
  Scene saturated;
  saturated.proposal.torque_nm[3] = 50.5;
  CHECK(saturated.ticks_until_it_acts() == 99);
}

TEST_CASE("judging takes no memory from the heap") {
  Scene scene;
  const auto before = test::allocations();
  scene.tick(100);
  scene.force_n = 90.0;
  scene.tick(100);
  CHECK(test::allocations() == before);
}

TEST_CASE("an arm of a single joint is guarded as any other") {
  Guard::Options options;
  options.torque_limit_nm = JointVector::Constant(1, 50.0);
  Scene scene(options);
  for (JointVector* of_joints : {&scene.seen.q_rad, &scene.seen.dq_rad_per_s,
                                 &scene.seen.gravity_nm, &scene.proposal.torque_nm})
    of_joints->setZero(1);
  scene.seen.jacobian.setZero(3, 1);
  scene.seen.mass_kg_m2.setIdentity(1, 1);
  CHECK(scene.tick(5).action == Action::pass);
}

TEST_CASE("what is seen of a fresh guard's last force is its newest median") {
  Scene scene;
  scene.tick(20);
  scene.force_n = 30.0;
  scene.tick(2);
  CHECK(scene.guard.felt_n() == doctest::Approx(30.0));
}
