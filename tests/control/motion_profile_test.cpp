// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/motion_profile.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::control;

namespace {

constexpr std::uint64_t seed = 7;

MotionLimits random_limits(Random& random) {
  return {std::pow(10.0, uniform(random, -2.0, 1.0)), std::pow(10.0, uniform(random, -1.0, 1.5)),
          std::pow(10.0, uniform(random, 0.0, 3.0))};
}

// A state from which the limits can be kept: taking the acceleration away leaves a permitted speed.
MotionState random_state(Random& random, const MotionLimits& limits) {
  for (;;) {
    const MotionState state = {
        uniform(random, -1.0, 1.0), uniform(random, -limits.speed_per_s, limits.speed_per_s),
        uniform(random, -limits.acceleration_per_s2, limits.acceleration_per_s2)};
    const double coast = state.speed_per_s + state.acceleration_per_s2 *
                                                 std::abs(state.acceleration_per_s2) /
                                                 (2.0 * limits.jerk_per_s3);
    if (std::abs(coast) <= limits.speed_per_s) return state;
  }
}

}  // namespace

TEST_CASE("a hundred thousand random motions keep their limits and end at rest at their goal") {
  Random random = make_random(seed, "motion");
  double worst_speed = 0.0, worst_acceleration = 0.0, worst_miss = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const MotionLimits limits = random_limits(random);
    const MotionState start = random_state(random, limits);
    const double goal = uniform(random, -1.0, 1.0) * std::pow(10.0, uniform(random, -6.0, 0.0));
    MotionProfile motion;
    REQUIRE(motion.plan(start, goal, limits));
    for (int k = 0; k <= 10; ++k) {
      const MotionState state = motion.at(motion.duration_s() * k / 10.0);
      worst_speed = std::max(worst_speed, std::abs(state.speed_per_s) / limits.speed_per_s);
      worst_acceleration = std::max(
          worst_acceleration, std::abs(state.acceleration_per_s2) / limits.acceleration_per_s2);
    }
    const MotionState last = motion.at(std::nextafter(motion.duration_s(), 0.0));
    worst_miss = std::max(worst_miss, std::abs(last.at - goal));
    REQUIRE(motion.at(motion.duration_s() + 1.0).at == goal);
  }
  CHECK(worst_speed < 1.0 + 1e-9);
  CHECK(worst_acceleration < 1.0 + 1e-9);
  CHECK(worst_miss < 1e-9);
}

TEST_CASE("what remains of the fastest motion is itself the fastest motion") {
  Random random = make_random(seed, "bellman");
  int inexact = 0;
  for (int i = 0; i < 20000; ++i) {
    const MotionLimits limits = random_limits(random);
    const MotionState start = random_state(random, limits);
    const double goal = uniform(random, -1.0, 1.0);
    MotionProfile motion, rest;
    REQUIRE(motion.plan(start, goal, limits));
    const double interrupted_s = motion.duration_s() * uniform(random, 0.0, 0.9);
    REQUIRE(rest.plan(motion.at(interrupted_s), goal, limits));
    CAPTURE(i);
    // In the last stretches the time depends on the cube root of the rounding of the place.
    const double left_s = motion.duration_s() - interrupted_s;
    REQUIRE(rest.duration_s() == doctest::Approx(left_s).epsilon(5e-3));
    if (std::abs(rest.duration_s() - left_s) > 1e-6 * left_s) ++inexact;
  }
  CHECK(inexact < 200);
}

TEST_CASE("from rest to rest the seven stretches take the time of the closed form") {
  // Speed and acceleration both reach their limits: T = d / v + v / a + a / j.
  MotionProfile motion;
  REQUIRE(
      motion.plan({}, 2.0, {.speed_per_s = 0.5, .acceleration_per_s2 = 1.0, .jerk_per_s3 = 10.0}));
  CHECK(motion.duration_s() == doctest::Approx(2.0 / 0.5 + 0.5 / 1.0 + 1.0 / 10.0));
  // Neither does: four equal stretches, T = 4 cbrt(d / (2 j)).
  REQUIRE(motion.plan({}, 1e-3,
                      {.speed_per_s = 5.0, .acceleration_per_s2 = 50.0, .jerk_per_s3 = 100.0}));
  CHECK(motion.duration_s() == doctest::Approx(4.0 * std::cbrt(1e-3 / 200.0)));
}

TEST_CASE("an axis that was pushed beyond its limits comes back inside and still arrives") {
  MotionProfile motion;
  const MotionLimits limits = {.speed_per_s = 0.1, .acceleration_per_s2 = 1.0, .jerk_per_s3 = 20.0};
  REQUIRE(motion.plan({0.0, 0.5, 3.0}, 1.0, limits));
  CHECK(motion.at(1.0).speed_per_s <= 0.1 + 1e-9);
  CHECK(std::abs(motion.at(motion.duration_s() - 1e-9).at - 1.0) < 1e-8);
}

TEST_CASE(
    "a motion may be interrupted at any tick without a jump of place, speed or acceleration") {
  Random random = make_random(seed, "interrupt");
  const MotionLimits limits = {
      .speed_per_s = 0.25, .acceleration_per_s2 = 1.0, .jerk_per_s3 = 10.0};
  MotionState state;
  MotionProfile motion;
  for (int tick = 0; tick < 20000; ++tick) {
    if (tick % 50 == 0) REQUIRE(motion.plan(state, uniform(random, -0.5, 0.5), limits));
    const MotionState next = motion.at((tick % 50 + 1) * 1e-3);
    CHECK(std::abs(next.at - state.at) <= 0.25e-3 + 1e-12);
    CHECK(std::abs(next.speed_per_s - state.speed_per_s) <= 1e-3 + 1e-12);
    CHECK(std::abs(next.acceleration_per_s2 - state.acceleration_per_s2) <= 10e-3 + 1e-12);
    state = next;
  }
}

TEST_CASE("numbers that are none are refused and the old motion goes on") {
  MotionProfile motion;
  const MotionLimits limits = {.speed_per_s = 1.0, .acceleration_per_s2 = 1.0, .jerk_per_s3 = 1.0};
  REQUIRE(motion.plan({}, 0.5, limits));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(motion.plan({}, nan, limits));
  CHECK_FALSE(motion.plan({0.0, nan, 0.0}, 1.0, limits));
  CHECK_FALSE(motion.plan({}, 1.0, {1.0, 0.0, 1.0}));
  CHECK(motion.goal() == 0.5);
}

TEST_CASE("a speed of a millionth of a millimetre per second does not upset the plan") {
  MotionProfile motion;
  const MotionLimits limits = {
      .speed_per_s = 0.25, .acceleration_per_s2 = 1.0, .jerk_per_s3 = 10.0};
  REQUIRE(motion.plan({1e-13, -1e-12, 1e-13}, 0.0, limits));
  CHECK(motion.duration_s() < 0.01);
  REQUIRE(motion.plan({0.0, -1e-12, 1e-13}, 1.0, limits));
  MotionProfile clean;
  REQUIRE(clean.plan({}, 1.0, limits));
  CHECK(motion.duration_s() == doctest::Approx(clean.duration_s()));
}
