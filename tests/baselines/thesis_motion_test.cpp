// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/thesis_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::baselines;
using namespace tuina::control;

namespace {

constexpr double dt_s = 1e-3;
constexpr ThesisMotion::Limits limits = {.speed_per_s = 0.2, .acceleration_per_s2 = 1.0};

}  // namespace

TEST_CASE("the thesis' generator arrives, within its limits of speed and acceleration") {
  Random random = make_random(3, "thesis motion");
  for (int i = 0; i < 200; ++i) {
    const double goal = uniform(random, -0.5, 0.5);
    ThesisMotion motion;
    motion.start(uniform(random, -0.5, 0.5));
    double time_s = 0.0;
    const double way = std::abs(goal - motion.planned().at);
    while (motion.planned().at != goal && time_s < 10.0) {
      const MotionState state = motion.step({}, goal, limits, dt_s);
      time_s += dt_s;
      REQUIRE(std::abs(state.speed_per_s) <= limits.speed_per_s + 1e-12);
    }
    CAPTURE(way);
    CHECK(motion.planned().at == goal);
    // A trapezoid of speed, which is the fastest there is without a bound on the jerk.
    const double v = limits.speed_per_s, a = limits.acceleration_per_s2;
    const double optimum_s = way > v * v / a ? way / v + v / a : 2.0 * std::sqrt(way / a);
    CHECK(time_s < 1.05 * optimum_s + 0.05);
  }
}

TEST_CASE("the thesis' generator has no bound on the jerk where ours has one") {
  ThesisMotion thesis;
  MotionProfile ours;
  REQUIRE(
      ours.plan({}, 0.3, {.speed_per_s = 0.2, .acceleration_per_s2 = 1.0, .jerk_per_s3 = 10.0}));
  double thesis_jerk = 0.0, our_jerk = 0.0, last = 0.0;
  for (int tick = 1; tick <= 2500; ++tick) {
    const double before = thesis.planned().acceleration_per_s2;
    const double now = thesis.step({}, 0.3, limits, dt_s).acceleration_per_s2;
    thesis_jerk = std::max(thesis_jerk, std::abs(now - before) / dt_s);
    const double acceleration = ours.at(tick * dt_s).acceleration_per_s2;
    our_jerk = std::max(our_jerk, std::abs(acceleration - last) / dt_s);
    last = acceleration;
  }
  CHECK(our_jerk <= 10.0 + 1e-6);
  CHECK(thesis_jerk > 900.0);
}

TEST_CASE("a goal moved behind the axis stops the thesis' generator in one tick") {
  ThesisMotion motion;
  for (int tick = 0; tick < 500; ++tick) motion.step({}, 0.3, limits, dt_s);
  const double before = motion.planned().speed_per_s;
  const double after = motion.step({}, motion.planned().at - 0.1, limits, dt_s).speed_per_s;
  CHECK(before == doctest::Approx(0.2));
  CHECK(std::abs(after - before) / dt_s > 100.0 * limits.acceleration_per_s2);
}

TEST_CASE("fed with the measured state the thesis' generator deadlocks on stiction") {
  // A mass of 3.5 kg on a spring of 3000 N/m to the plan; 8 N of friction hold it where it is.
  for (const auto feeds : {ThesisMotion::Feeds::measured, ThesisMotion::Feeds::planned}) {
    ThesisMotion motion;
    MotionState tool;
    for (int tick = 0; tick < 3000; ++tick) {
      const MotionState plan = motion.step(tool, 0.1, limits, dt_s, feeds);
      const double spring_n =
          3000.0 * (plan.at - tool.at) + 100.0 * (plan.speed_per_s - tool.speed_per_s);
      const bool slips = std::abs(spring_n) > 8.0 || tool.speed_per_s != 0.0;
      if (!slips) continue;
      const double friction_n =
          std::copysign(8.0, tool.speed_per_s != 0.0 ? tool.speed_per_s : spring_n);
      const double next = tool.speed_per_s + (spring_n - friction_n) / 3.5 * dt_s;
      tool.speed_per_s = tool.speed_per_s != 0.0 && next * tool.speed_per_s < 0.0 ? 0.0 : next;
      tool.at += tool.speed_per_s * dt_s;
    }
    if (feeds == ThesisMotion::Feeds::measured) {
      CHECK(tool.at == 0.0);  // never left
    } else {
      CHECK(std::abs(tool.at - 0.1) < 0.004);  // friction over stiffness
    }
  }
}

TEST_CASE("numbers that are none leave the thesis' generator at rest") {
  ThesisMotion motion;
  motion.start(0.1);
  for (int tick = 0; tick < 100; ++tick) motion.step({}, 0.3, limits, dt_s);
  const double at = motion.planned().at;
  CHECK(motion.step({}, std::numeric_limits<double>::quiet_NaN(), limits, dt_s).at == at);
  CHECK(motion.planned().speed_per_s == 0.0);
}
