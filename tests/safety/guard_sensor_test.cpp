// SPDX-License-Identifier: Apache-2.0
// A wrist sensor that is wild, silent, stuck or turned round.
#include <cmath>

#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// A scene with numbers that are exact: skin that faces up, and a sensor without noise.
Scene exact_scene(double force_n, const Guard::Options& options = six_joints()) {
  Scene scene(options);
  scene.face(Vector3::UnitZ());
  scene.noise_n = 0.0;
  scene.force_n = force_n;
  return scene;
}

}  // namespace

TEST_CASE(
    "a jump of the force by 25 N is followed; by more, up or down, it waits for two more samples") {
  for (const double direction : {1.0, -1.0}) {
    Scene scene = exact_scene(30.0);
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

TEST_CASE("a wild sample that is sent three times with one stamp is one sample") {
  Scene scene;
  scene.tick(100);
  scene.force_n = 500.0;
  CHECK(scene.tick().cause == Cause::force_spike);
  scene.sensor_alive = false;
  CHECK(scene.tick(2).action == Action::pass);
  scene.sensor_alive = true;
  scene.force_n = 20.0;
  CHECK(scene.tick(10).action == Action::pass);
  scene.force_n = 500.0;  // the next one is suspected as long as the first
  CHECK(scene.tick(2).action == Action::warn);
}

TEST_CASE("nothing is judged before three samples: the first may be wild or none") {
  for (const double first_n : {500.0, -500.0, 0.0, not_a_number}) {
    Scene scene;
    scene.force_n = first_n;
    CHECK(scene.tick().cause == Cause::none);
    scene.force_n = 24.0;
    CHECK(scene.tick(10).cause == Cause::none);
    CHECK(scene.guard.felt_n() == doctest::Approx(24.0));
  }
  Scene pressed;
  pressed.force_n = 60.5;
  CHECK(pressed.tick().action == Action::pass);
  CHECK(pressed.guard.felt_n() == 0.0);
  CHECK(pressed.tick().action == Action::pass);
  CHECK(pressed.tick().cause == Cause::force_over_trip);
  // The fourth is compared with the third, whatever they are.
  Scene jumping;
  jumping.tick(2);
  jumping.force_n = 50.0;
  CHECK(jumping.tick().cause == Cause::none);
  jumping.force_n = 20.0;
  CHECK(jumping.tick().cause == Cause::force_spike);
}

TEST_CASE("five wild samples within a thousand ticks are a fault of the sensor") {
  const auto spikes = [](int apart_ticks, int long_ticks) {
    Scene scene;
    scene.tick(10);
    for (int spike = 0; spike < 4; ++spike) {
      scene.force_n = 500.0;
      for (int i = 0; i < long_ticks; ++i) CHECK(scene.tick().action == Action::warn);
      scene.force_n = 20.0;
      CHECK(scene.tick(apart_ticks - long_ticks - 3).action == Action::pass);
      scene.miss(2);  // ticks count whether they were seen or not
      CHECK(scene.tick().action == Action::warn);
    }
    scene.force_n = 500.0;
    return scene.tick();
  };
  CHECK(spikes(250, 1).action == Action::warn);
  CHECK(spikes(251, 2).action == Action::warn);
  CHECK(spikes(1250, 1).action == Action::warn);
  for (const int long_ticks : {1, 2}) {
    const Verdict verdict = spikes(249, long_ticks);
    CHECK(verdict.action == Action::retract);
    CHECK(verdict.cause == Cause::force_spikes);
    CHECK(verdict.latched);
  }
}

TEST_CASE("the fifth wild sample may come 1000 ticks after the first, 999 are too soon") {
  for (const int last_ticks : {249, 250}) {
    Scene scene;
    scene.tick(10);
    for (const int ticks : {250, 250, 250, last_ticks}) {
      scene.force_n = 500.0;
      scene.tick();
      scene.force_n = 20.0;
      CHECK(scene.tick(ticks - 1).action == Action::pass);
    }
    scene.force_n = 500.0;
    CHECK(scene.tick().action == (last_ticks == 249 ? Action::retract : Action::warn));
  }
}

TEST_CASE("a sensor that falls silent freezes the arm after 3 ms and makes it leave after 5 ms") {
  // The last sample was as old as that when it came.
  const auto silent = [](double lag_s, int ticks) {
    Scene scene;
    scene.sensor_lag_s = lag_s;
    scene.tick(10);
    scene.sensor_alive = false;
    return scene.tick(ticks);
  };
  CHECK(silent(1.0e-3 + 0.995e-6, 2).action == Action::pass);
  CHECK(silent(1.0e-3 + 1.005e-6, 2).action == Action::freeze);
  CHECK(silent(1.0e-3 + 1.005e-6, 2).cause == Cause::force_stale);
  CHECK_FALSE(silent(1.0e-3 + 0.995e-6, 4).latched);
  CHECK(silent(1.0e-3 + 0.995e-6, 4).action == Action::freeze);
  CHECK(silent(1.0e-3 + 1.005e-6, 4).action == Action::retract);
  CHECK(silent(1.0e-3 + 1.005e-6, 4).cause == Cause::force_stale);
  CHECK(silent(1.0e-3 + 1.005e-6, 4).latched);
  CHECK(silent(0.0, 3).action == Action::pass);
  CHECK(silent(0.0, 4).action == Action::freeze);
  CHECK(silent(-2e-3, 3).action == Action::pass);  // one from the future is as new as can be
  CHECK(silent(-2e-3, 4).action == Action::freeze);
}

TEST_CASE("a sample ages by the ticks that went by, seen or missed, and not by the clock") {
  Scene missed;
  missed.tick(10);
  missed.sensor_alive = false;
  missed.miss(2);
  CHECK(missed.tick().cause == Cause::force_stale);
  CHECK(missed.verdict.action == Action::freeze);
  Scene slow;
  slow.tick(10);
  slow.sensor_alive = false;
  for (int i = 0; i < 2; ++i) slow.tick_at(slow.seen.time_s + 0.6e-3);
  CHECK(slow.verdict.action == Action::pass);
  slow.tick_at(slow.seen.time_s + 0.6e-3);
  CHECK(slow.verdict.cause == Cause::force_stale);
}

TEST_CASE("an arm that was frozen for want of samples goes on when they come again") {
  Scene scene;
  scene.tick(100);
  scene.sensor_alive = false;
  CHECK(scene.tick(3).action == Action::freeze);
  scene.sensor_alive = true;
  CHECK(scene.tick().action == Action::pass);
}

TEST_CASE("a sensor that says NaN counts as silent, from its first sample on") {
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
}

TEST_CASE("a sample that is sent again, is older than the last, or has no time is no new sample") {
  for (const double time_s : {0.05, -infinity, not_a_number}) {
    Scene scene;
    scene.tick(100);
    scene.sensor_alive = false;
    scene.seen.wrench_time_s = time_s;
    CHECK(scene.tick(10).cause == Cause::force_stale);
  }
  for (const double older_s : {0.0, 0.5e-3, 3.9e-3}) {
    Scene scene;
    scene.tick(100);
    scene.sensor_alive = false;
    scene.seen.wrench_time_s -= older_s;
    scene.force_n = 500.0;
    CHECK(scene.tick().action == Action::pass);  // those 500 N are not even a spike
  }
}

TEST_CASE("clocks of arm and sensor may differ by 5 ms, beyond that a sample is none") {
  const auto differing = [](double lag_s) {
    Scene scene;
    scene.tick(10);
    scene.sensor_lag_s = lag_s;
    scene.force_n = 500.0;
    scene.seen.time_s += 9e-3;  // once, a clock may be set
    return scene.tick().cause;
  };
  CHECK(differing(-4.99e-3) == Cause::force_spike);
  CHECK(differing(-5.01e-3) == Cause::none);
  CHECK(differing(-1e6) == Cause::none);
  CHECK(differing(-2e-6) == Cause::force_spike);
  Scene old;
  old.sensor_lag_s = 4.99e-3;
  CHECK(old.tick(20).action == Action::freeze);  // never newer than that, but there
  old.sensor_lag_s = 5.01e-3;
  CHECK(old.tick(2).action == Action::retract);
}

TEST_CASE("a sensor that repeats itself ten times is stuck, whether the tool moves or not") {
  Scene scene;
  scene.seen.wrist_repeats = 9;
  CHECK(scene.tick(10).action == Action::pass);
  scene.seen.wrist_repeats = 10;
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_stuck);
  CHECK(scene.verdict.latched);
  Scene late;
  late.seen.wrist_repeats = 25;
  CHECK(late.tick().action == Action::retract);
  CHECK(Observation{}.wrist_repeats == 0);
}

TEST_CASE("a force over 8 N that points aside or inward for ten samples is not believed") {
  const auto turned = [](double force_n, double cosine, Phase phase, int ticks) {
    Scene scene;
    scene.force_n = force_n;
    scene.face(Vector3::UnitZ());
    scene.proposal.phase = phase;
    scene.tick(10);
    scene.pushed_along = {std::sqrt(1.0 - cosine * cosine), 0.0, cosine};
    return scene.tick(ticks);
  };
  CHECK(turned(20.0, -1.0, Phase::contact, 9).action == Action::pass);
  CHECK(turned(20.0, -1.0, Phase::contact, 10).action == Action::comply);
  CHECK(turned(20.0, -1.0, Phase::contact, 10).cause == Cause::force_reversed);
  CHECK(turned(20.0, -1.0, Phase::contact, 10).latched);
  CHECK(turned(8.01, -1.0, Phase::approach, 10).action == Action::comply);
  CHECK(turned(7.99, -1.0, Phase::contact, 100).action == Action::pass);
  CHECK(turned(20.0, 0.249, Phase::contact, 10).action == Action::comply);
  CHECK(turned(20.0, 0.251, Phase::contact, 100).action == Action::pass);
  for (const Phase phase : {Phase::free, Phase::retract})
    CHECK(turned(20.0, -1.0, phase, 100).action == Action::pass);
  Scene scene;
  scene.tick(10);
  for (int i = 0; i < 3; ++i) {  // it must last
    scene.pushed_along = -scene.normal();
    CHECK(scene.tick(9).action == Action::pass);
    scene.pushed_along = scene.normal();
    CHECK(scene.tick().action == Action::pass);
  }
}

TEST_CASE("what a sensor says that is not believed makes no tool leave, nor follow") {
  Scene stuck;  // in the air
  stuck.force_n = 0.0;
  stuck.tick(10);
  stuck.seen.wrist_repeats = 10;
  stuck.tick();
  REQUIRE(stuck.verdict.cause == Cause::force_stuck);
  stuck.seen.wrist_repeats = 0;
  stuck.force_n = 20.0;
  CHECK(stuck.tick(10).action == Action::retract);
  CHECK(stuck.outward_n() < 5.0);
  Scene reversed;
  reversed.tick(10);
  reversed.pushed_along = -reversed.normal();
  reversed.tick(10);
  REQUIRE(reversed.verdict.cause == Cause::force_reversed);
  reversed.pushed_along = reversed.normal();
  reversed.retract();
  reversed.seen.tool_in_base += 0.21 * reversed.normal();
  reversed.tick(10);
  CHECK(reversed.outward_n() < 5.0);
}
