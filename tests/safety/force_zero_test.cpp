// SPDX-License-Identifier: Apache-2.0
// The zero of a wrist sensor: who takes it, by how much, and what is made of one that has moved.
#include <algorithm>
#include <cmath>

#include "tests/safety/scene.hpp"
#include "tests/safety/two_arms.hpp"

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
