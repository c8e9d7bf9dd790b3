// SPDX-License-Identifier: Apache-2.0
// The zero of a wrist sensor: who takes it, by how much, and what is made of one that has moved or
// jumps.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/safety/scene.hpp"
#include "tests/safety/two_arms.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE("when an approach begins the wrist is zeroed, by 3 N at most at first") {
  for (const double drift_n : {1.0, 3.0, 4.0, 30.0}) {
    Standing arm;
    arm.pushed_n = drift_n * Vector3(0.6, 0.0, 0.8);
    CHECK((arm.observe_for(300).force_in_base_n - arm.pushed_n).norm() < 1e-9);
    const double left_n = std::max(drift_n - 3.0, 0.0);
    CHECK((arm.observe(Phase::approach).force_in_base_n - left_n / drift_n * arm.pushed_n).norm() <
          0.01);
    arm.pushed_n.setZero();  // and stays so, for this approach and what follows
    const double taken_n = std::min(drift_n, 3.0);
    CHECK(arm.observe_for(300, Phase::approach).force_in_base_n.norm() ==
          doctest::Approx(taken_n).epsilon(5e-3));
    CHECK(arm.observe_for(300, Phase::contact).force_in_base_n.norm() ==
          doctest::Approx(taken_n).epsilon(5e-3));
    CHECK(arm.observe_for(300, Phase::free).force_in_base_n.norm() ==
          doctest::Approx(taken_n).epsilon(5e-3));
    arm.observe_for(10, Phase::contact);
    CHECK(arm.observe(Phase::approach).force_in_base_n.norm() < 0.01);
    arm.pushed_n.x() = 1.0;
    arm.observe_for(1000, Phase::retract);
    CHECK(arm.observe(Phase::approach).force_in_base_n.norm() < 0.01);
  }
}

TEST_CASE("a sensor that drifts is zeroed by 1 N more for each minute that was watched") {
  Standing arm;
  arm.observe_for(30'000);
  arm.pushed_n = {0.0, 0.0, 9.0};
  arm.observe_for(3'000);
  const double zeroed_n = 3.0 + 33.0 / 60.0;
  CHECK(arm.observe(Phase::approach).force_in_base_n.z() ==
        doctest::Approx(9.0 - zeroed_n).epsilon(1e-4));
  // Whoever asks for approaches again and again gets no more by it.
  for (int i = 0; i < 200; ++i) arm.observe(i % 2 == 0 ? Phase::free : Phase::approach);
  CHECK(arm.observe(Phase::free).force_in_base_n.z() ==
        doctest::Approx(9.0 - zeroed_n).epsilon(1e-3));
  // A clock that jumps counts as ten milliseconds.
  arm.reading.tick += 1'000'000;
  arm.observe_for(200);
  CHECK(arm.observe(Phase::approach).force_in_base_n.z() ==
        doctest::Approx(9.0 - zeroed_n).epsilon(2e-3));
}

TEST_CASE("an arm at rest that feels more or less than its tool is seen at the first look") {
  for (const double off_n : {-1.5, 4.9}) {
    Standing arm;
    arm.pushed_n.z() = off_n;
    CHECK(arm.observe_for(49).zero_jump_n == 0.0);
    CHECK(arm.observe().zero_jump_n ==
          doctest::Approx(std::abs(off_n) - 0.05 / 60.0).epsilon(1e-4));
    arm.pushed_n.setZero();  // and it is told for as long as nobody has zeroed the sensor
    CHECK(arm.observe_for(500).zero_jump_n > 1.4);
  }
  // One that is in contact when the guard begins is looked at when it is in the air again.
  Standing pressing;
  pressing.pushed_n.z() = 20.0;
  for (const Phase phase : {Phase::contact, Phase::approach, Phase::retract}) {
    if (phase != Phase::approach) CHECK(pressing.observe_for(300, phase).zero_jump_n == 0.0);
  }
}

TEST_CASE("a zero that has moved from approach to approach by more than drift is seen") {
  for (const double moved_n : {1.0, 2.0}) {
    Standing arm;
    arm.pushed_n.x() = 0.7;
    arm.observe_for(1000);
    CHECK(arm.observe(Phase::approach).zero_jump_n == doctest::Approx(0.7 - 1.001 / 60.0));
    arm.observe_for(2000, Phase::contact);
    arm.pushed_n.x() += moved_n;
    const double before_n = arm.observe_for(3000, Phase::free).zero_jump_n;
    CHECK(before_n == doctest::Approx(0.7 - 1.001 / 60.0));
    CHECK(arm.observe(Phase::approach).zero_jump_n == doctest::Approx(moved_n - 5.001 / 60.0));
  }
}

TEST_CASE("a wrist off its zero brakes an arm in the air; one that presses somebody leaves") {
  const auto off = [](double felt_n, double jump_n) {
    Scene scene;
    scene.face(Vector3::UnitZ());
    scene.force_n = felt_n;
    scene.tick(10);
    scene.seen.zero_jump_n = jump_n;
    return scene.tick();
  };
  CHECK(off(4.9, 1.2).action == Action::pass);
  CHECK(off(4.9, 1.201).action == Action::brake);
  CHECK(off(4.9, 1.201).cause == Cause::force_off_zero);
  CHECK(off(4.9, 1.201).latched);
  CHECK(off(5.1, 1.2).action == Action::pass);
  CHECK(off(5.1, 1.201).action == Action::retract);
  CHECK(off(5.1, 1.201).cause == Cause::force_off_zero);
}

namespace {

/// Whether an arm whose wrist feels these forces, one after the other, and then the last one, is
/// told of a sensor that steps.
bool steps(const std::vector<double>& felt_n, double sampled_s = 1e-3) {
  Standing arm;
  arm.observe_for(10);
  bool stepped = false;
  for (std::size_t i = 0; i < felt_n.size() + 10; ++i) {
    arm.pushed_n = Vector3(0.6, 0.0, -0.8) * felt_n[std::min(i, felt_n.size() - 1)];
    arm.arm().wrench_in_tool = wrist_of(arm.model, arm.arm().q_rad, arm.pushed_n);
    arm.reading.time_s += sampled_s - 1e-3;
    stepped = arm.look().wrist_stepped || stepped;
  }
  return stepped;
}

}  // namespace

TEST_CASE("a force that comes within one sample and stays is the sensor's own from 2.5 N on") {
  CHECK_FALSE(steps({0.0}));
  for (const double sign : {1.0, -1.0}) {
    CHECK_FALSE(steps({sign * 2.49}));
    CHECK(steps({sign * 2.51}));
    CHECK(steps({sign * 500.0}));
  }
  CHECK_FALSE(steps({500.0, 0.0}));  // one wild sample, two, and one each way
  CHECK_FALSE(steps({500.0, 500.0, 0.0}));
  CHECK_FALSE(steps({500.0, -500.0, 0.0}));
  // What a filter of a sensor makes of a sudden force goes on, up to 250 Hz.
  for (const double cutoff_hz : {100.0, 250.0, 260.0}) {
    std::vector<double> filtered_n = {0.0};
    for (int i = 0; i < 20; ++i) {
      const double share = 1.0 - std::exp(-2.0 * pi * cutoff_hz * 1e-3);
      filtered_n.push_back(filtered_n.back() + share * (60.0 - filtered_n.back()));
    }
    CHECK(steps(filtered_n) == (cutoff_hz > 250.0));
  }
  // A fifth of the step before and after it is no calm.
  for (const double share : {0.19, 0.21}) {
    const double more_n = 10.0 * share;
    for (std::size_t later = 1; later <= 4; ++later) {
      std::vector<double> after_n(later, 10.0);
      after_n.push_back(10.0 + more_n);
      CHECK(steps(after_n) == (share < 0.2));
    }
    CHECK(steps({10.0, 10.0, 10.0, 10.0, 10.0, 10.0 + more_n}));  // by then it is known
    CHECK(steps({more_n, 10.0 + more_n}) == (share < 0.2));
    CHECK(steps({more_n, more_n, 10.0 + more_n}) == (share < 0.2));
  }
  CHECK(steps({10.0}, 1.4e-3));
  CHECK_FALSE(steps({10.0}, 1.6e-3));  // it has had time for it
}

TEST_CASE("a sample that comes again is no change of its own") {
  Standing arm;
  arm.observe_for(10);
  arm.pushed_n.z() = 10.0;
  CHECK_FALSE(arm.observe().wrist_stepped);
  arm.observe();
  const double old_s = arm.arm().wrench_time_s;
  for (int i = 0; i < 3; ++i) {
    arm.reading.tick += 1;
    arm.arm().wrench_time_s = old_s;
    CHECK_FALSE(arm.watch.observe(arm.reading, Arm::left, {}, {}).wrist_stepped);
  }
  CHECK_FALSE(Observation{}.wrist_stepped);
}

TEST_CASE("the first sample of all is no step") {
  Standing arm;
  arm.pushed_n.z() = 10.0;
  for (int i = 0; i < 10; ++i) CHECK_FALSE(arm.observe().wrist_stepped);
}

TEST_CASE("an arm whose wrist steps leaves, and believes it no more") {
  Scene scene;
  scene.force_n = 0.0;
  scene.tick(10);
  scene.force_n = 20.0;
  scene.seen.wrist_stepped = true;
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_off_zero);
  CHECK(scene.verdict.latched);
  scene.seen.wrist_stepped = false;
  scene.tick(100);
  CHECK(scene.outward_n() < 41.0);  // not the 80 N with which a felt body is left
}
