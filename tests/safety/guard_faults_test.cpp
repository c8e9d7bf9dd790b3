// SPDX-License-Identifier: Apache-2.0
// Sensors, clocks and proposals that are broken.
#include "tests/allocation.hpp"
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE(
    "a jump of the force by 25 N is followed; by more, up or down, it waits for two more samples") {
  for (const double direction : {1.0, -1.0}) {
    Scene scene;
    scene.force_n = 30.0;
    scene.tick(100);
    scene.force_n = 30.0 + direction * 25.0;
    CHECK(scene.tick().action == Action::pass);
    scene.force_n = 30.0;
    scene.tick(100);
    scene.force_n = 30.0 + direction * 25.01;
    for (int sample = 0; sample < 2; ++sample) {
      CHECK(scene.tick().action == Action::warn);
      CHECK(scene.verdict.cause == Cause::force_spike);
      CHECK_FALSE(scene.verdict.latched);
    }
    CHECK(scene.tick().action == Action::pass);
  }
}

TEST_CASE("500 N that stay are believed at the third sample and end the contact at the fourth") {
  Scene scene;
  scene.tick(100);
  scene.force_n = 500.0;
  CHECK(scene.tick(2).action == Action::warn);
  CHECK(scene.tick().action == Action::pass);
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_over_trip);
}

TEST_CASE(
    "five wild samples within a second are a fault of the sensor, over a second or more they are "
    "not") {
  const auto spikes = [](double apart_s, int long_ticks) {
    Scene scene;
    scene.tick_at(0.99);
    for (int spike = 0; spike < 5; ++spike) {
      for (int i = 0; i < (spike == 2 ? long_ticks : 1); ++i) {
        scene.force_n = 500.0;
        scene.tick_at(1.0 + spike * apart_s + i * 1e-3);
        if (spike < 4) CHECK(scene.verdict.action == Action::warn);
      }
      scene.force_n = 20.0;
      const Verdict last = scene.verdict;
      scene.tick_at(1.0 + spike * apart_s + 5e-3);
      if (spike < 4) CHECK(scene.verdict.action == Action::pass);
      if (spike == 4) return last;
    }
    return scene.verdict;
  };
  CHECK(spikes(0.25, 1).action == Action::warn);  // a whole second
  CHECK(spikes(0.2513, 1).action == Action::warn);
  for (const int long_ticks : {1, 2}) {
    const Verdict verdict = spikes(0.2488, long_ticks);
    CHECK(verdict.action == Action::retract);
    CHECK(verdict.cause == Cause::force_spikes);
    CHECK(verdict.latched);
  }
}

TEST_CASE(
    "a force sensor that falls silent freezes the arm after 3 ms and makes it leave after 5 ms") {
  const auto aged = [](double age_s) {
    Scene scene;
    scene.tick_at(1.0 / 1024.0);
    scene.tick_at(4.0 / 1024.0);
    scene.sensor_alive = false;
    return scene.tick_at(scene.seen.wrench_time_s + age_s);
  };
  CHECK(aged(3.000995e-3).action == Action::pass);
  CHECK(aged(3.001005e-3).action == Action::freeze);
  CHECK(aged(3.001005e-3).cause == Cause::force_stale);
  CHECK_FALSE(aged(5.000995e-3).latched);
  CHECK(aged(5.000995e-3).action == Action::freeze);
  CHECK(aged(5.001005e-3).action == Action::retract);
  CHECK(aged(5.001005e-3).cause == Cause::force_stale);
  CHECK(aged(5.001005e-3).latched);
}

TEST_CASE("an arm that was frozen for want of samples goes on when they come again") {
  Scene scene;
  scene.tick(100);
  scene.sensor_alive = false;
  CHECK(scene.tick(3).action == Action::freeze);
  scene.sensor_alive = true;
  CHECK(scene.tick().action == Action::pass);
}

TEST_CASE("a force sensor that says NaN counts as silent, from its first sample on") {
  for (const double bad : {not_a_number, infinity}) {
    for (const int good_ticks : {0, 100}) {
      Scene scene;
      scene.seen.time_s = 100.0;
      scene.tick(good_ticks);
      scene.force_n = bad;
      CHECK(scene.tick(2).action == Action::pass);
      CHECK(scene.tick(6).action == Action::retract);
      CHECK(scene.verdict.cause == Cause::force_stale);
    }
  }
  Scene scene;
  scene.force_n = not_a_number;
  scene.tick();
  scene.force_n = 70.0;  // nothing was felt before, so this is a jump
  CHECK(scene.tick().cause == Cause::force_spike);
  CHECK(scene.tick().cause == Cause::force_spike);
  CHECK(scene.tick().cause == Cause::none);
}

TEST_CASE("after a first sample that is NaN nothing counts as felt") {
  for (const double force_n : {24.5, 25.5}) {
    Scene scene;
    scene.force_n = not_a_number;
    scene.tick();
    scene.force_n = force_n;
    CHECK(scene.tick().cause == (force_n > 25.0 ? Cause::force_spike : Cause::none));
  }
}

TEST_CASE("a sample is as old as it may be to the last bit") {
  const double first_s = 4.0 / 1024.0, second_s = 5.5 / 1024.0;
  const double age_s = second_s - (first_s - 1e-3) - 1e-6;
  for (const bool leaves : {false, true}) {
    for (const double short_by_s : {0.0, 1e-9}) {
      Guard::Options options = six_joints();
      options.limits.stale_freeze_s = leaves ? 1e-3 : 1e-3 * 3.0;
      (leaves ? options.limits.stale_retract_s : options.limits.stale_freeze_s) =
          age_s - short_by_s;
      Scene scene(options);
      scene.tick_at(1.0 / 1024.0);
      scene.tick_at(first_s);
      scene.sensor_alive = false;
      const Action milder = leaves ? Action::freeze : Action::pass;
      const Action harder = leaves ? Action::retract : Action::freeze;
      CHECK(scene.tick_at(second_s).action == (short_by_s > 0.0 ? harder : milder));
    }
  }
}

TEST_CASE("a sample that is sent again, is older than the last, or has no time is no new sample") {
  for (const double time_s : {0.05, -infinity, not_a_number}) {
    Scene scene;
    scene.tick(100);
    scene.sensor_alive = false;
    scene.seen.wrench_time_s = time_s;
    CHECK(scene.tick(10).cause == Cause::force_stale);
  }
  Scene scene;
  scene.tick(100);
  scene.sensor_alive = false;
  scene.force_n = 500.0;
  scene.seen.wrench_time_s = -infinity;
  CHECK(scene.tick().action == Action::pass);  // those 500 N are not even a spike
}

TEST_CASE("a sample from the future is none, but clocks may differ by a microsecond") {
  const auto ahead = [](double ahead_s) {
    Scene scene;
    scene.tick_at(1.0 / 1024.0);
    scene.sensor_alive = false;
    scene.force_n = 500.0;
    scene.seen.wrench_time_s = 2.0 / 1024.0 + ahead_s;
    return scene.tick_at(2.0 / 1024.0).cause;
  };
  CHECK(ahead(0.995e-6) == Cause::force_spike);
  CHECK(ahead(1e-6) == Cause::force_spike);
  CHECK(ahead(1.005e-6) == Cause::none);
  CHECK(ahead(1e6) == Cause::none);
}

TEST_CASE(
    "one or two missed ticks warn, three to nine freeze for a tenth of a second, ten end the "
    "contact") {
  for (std::uint64_t missed = 1; missed <= 10; ++missed) {
    Scene scene;
    scene.tick(10);
    scene.seen.tick += missed;
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
  const double late_s = scene.seen.time_s + 1e-3;
  scene.freeze();
  CHECK(scene.tick(98).action == Action::freeze);
  CHECK(scene.tick_at(late_s + 0.0995).action == Action::freeze);
  CHECK(scene.verdict.cause == Cause::late_tick);
  CHECK(scene.tick_at(late_s + 0.1).action < Action::freeze);
}

TEST_CASE("ticks that repeat or run backwards end the contact") {
  for (const std::uint64_t back : {1u, 5u}) {
    Scene scene;
    scene.tick(100);
    scene.seen.tick -= back;
    CHECK(scene.tick().action == Action::retract);
    CHECK(scene.verdict.cause == Cause::late_tick);
  }
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
      [](Observation& seen) { seen.jacobian.setZero(3, 7); }};
  for (const auto& spoil : faults) {
    for (const bool wound_up : {false, true}) {
      Scene scene;
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

TEST_CASE("a guard that begins in the middle of a fault counts from nothing") {
  const std::vector<void (*)(Scene&)> faults = {
      [](Scene& s) { s.seen.dq_rad_per_s[0] = 5.0; },
      [](Scene& s) { s.seen.tool_velocity_m_per_s.x() = -0.3; },
      [](Scene& s) { s.seen.tool_velocity_m_per_s = 0.13 * s.normal(); },
      [](Scene& s) { s.proposal.torque_nm[3] = infinity; }};
  for (const auto& spoil : faults) {
    Scene scene;
    spoil(scene);
    CHECK(scene.ticks_until_it_acts() == 2);
  }
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
