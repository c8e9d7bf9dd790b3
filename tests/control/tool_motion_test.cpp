// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/tool_motion.hpp"

#include <doctest/doctest.h>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::control;

namespace {

ToolPose random_pose(Random& random) {
  const auto vector = [&] {
    return Vector3(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0),
                   uniform(random, -1.0, 1.0));
  };
  return {0.3 * vector(), (vector() + 1.2 * Vector3::UnitZ()).normalized()};
}

}  // namespace

TEST_CASE("from rest the tool runs straight and its normal turns about one axis") {
  ToolMotion motion;
  motion.start({Vector3(0.1, 0.0, 0.3), Vector3::UnitZ()});
  const ToolPose goal = {Vector3(0.2, 0.2, 0.1), Vector3(1.0, 0.0, 1.0).normalized()};
  REQUIRE(motion.plan(0.0, goal, {}));
  for (int k = 0; k <= 20; ++k) {
    const ToolPose pose = motion.at(motion.duration_s() * k / 20.0).pose;
    const Vector3 way = goal.at_in_base - Vector3(0.1, 0.0, 0.3);
    CHECK(way.cross(pose.at_in_base - Vector3(0.1, 0.0, 0.3)).norm() < 1e-9);
    CHECK(std::abs(pose.normal_in_base.y()) < 1e-9);
  }
  CHECK((motion.at(motion.duration_s()).pose.at_in_base - goal.at_in_base).norm() < 1e-12);
  CHECK((motion.at(motion.duration_s()).pose.normal_in_base - goal.normal_in_base).norm() < 1e-12);
}

TEST_CASE("a tool that is sent elsewhere again and again never jumps and never exceeds its speed") {
  Random random = make_random(3, "poses");
  const ToolMotion::Limits limits;
  ToolMotion motion;
  motion.start(random_pose(random));
  ToolReference last = motion.at(0.0);
  int tick_of_plan = 0;
  double fastest = 0.0;
  for (int tick = 0; tick < 30000; ++tick) {
    if (tick % 400 == 0) {
      REQUIRE(motion.plan((tick - tick_of_plan) * 1e-3, random_pose(random), limits));
      tick_of_plan = tick;
    }
    const ToolReference now = motion.at((tick + 1 - tick_of_plan) * 1e-3);
    const double step = (now.pose.at_in_base - last.pose.at_in_base).norm();
    const double turn = (now.pose.normal_in_base - last.pose.normal_in_base).norm();
    fastest = std::max(fastest, step / 1e-3);
    CHECK((now.velocity_m_per_s - last.velocity_m_per_s).norm() < 1.4e-3 * 0.6 + 1e-9);
    CHECK(turn < 1.3e-3);
    last = now;
  }
  CHECK(fastest <= 0.20 * 1.02);
  CHECK(fastest > 0.15);
}

TEST_CASE("whatever the goals and the instants they change at, the tool keeps within its limits") {
  Random random = make_random(7, "goals");
  const ToolMotion::Limits limits;
  constexpr double dt_s = 2e-3, rounding = 1.0 + 1e-6;
  const auto anywhere = [&] {
    const ToolPose pose = random_pose(random);
    return ToolPose{pose.at_in_base, uniform(random, -1.0, 1.0) < 0.0
                                         ? Vector3(-pose.normal_in_base)
                                         : pose.normal_in_base};
  };
  double max_speed = 0.0, max_turn = 0.0, max_push = 0.0, max_twist = 0.0, max_duration_s = 0.0;
  double max_lie = 0.0;  // between the speed that it tells and the one that it has
  for (int k = 0; k < 400; ++k) {
    ToolMotion motion;
    motion.start(anywhere());
    double time_s = 0.0;
    for (int leg = 0; leg < 5; ++leg) {
      const ToolReference before = motion.at(time_s);
      ToolPose goal = anywhere();
      // Nearly opposite to where the tool points now, and straight ahead of it.
      if (leg == 2) goal.normal_in_base = 1e-3 * goal.normal_in_base - before.pose.normal_in_base;
      if (leg == 3) goal = motion.goal();
      REQUIRE(motion.plan(time_s, goal, limits));
      max_duration_s = std::max(max_duration_s, motion.duration_s());
      ToolReference last = motion.at(0.0);
      CHECK((last.pose.at_in_base - before.pose.at_in_base).norm() < 1e-8);
      CHECK((last.pose.normal_in_base - before.pose.normal_in_base).norm() < 1e-8);
      CHECK((last.velocity_m_per_s - before.velocity_m_per_s).norm() < 1e-8);
      CHECK((last.turning_rad_per_s - before.turning_rad_per_s).norm() < 1e-8);
      const double until_s = uniform(random, 0.0, 1.1) * std::min(motion.duration_s(), 12.0);
      for (time_s = dt_s; time_s < until_s; time_s += dt_s) {
        const ToolReference now = motion.at(time_s);
        const auto per_s = [&](const Vector3& from, const Vector3& to) {
          return (to - from).norm() / dt_s;
        };
        const double speed = per_s(last.pose.at_in_base, now.pose.at_in_base);
        const double turn = per_s(last.pose.normal_in_base, now.pose.normal_in_base);
        const double push = per_s(last.velocity_m_per_s, now.velocity_m_per_s);
        const double twist = per_s(last.turning_rad_per_s, now.turning_rad_per_s);
        max_speed = std::max(max_speed, speed);
        max_turn = std::max(max_turn, turn);
        max_push = std::max(max_push, push);
        max_twist = std::max(max_twist, twist);
        const Vector3 turning = now.turning_rad_per_s.cross(now.pose.normal_in_base);
        max_lie = std::max({max_lie, std::abs(turning.norm() - turn),
                            std::abs(now.velocity_m_per_s.norm() - speed)});
        last = now;
      }
      time_s -= dt_s;
    }
  }
  CHECK(max_speed > 0.19);
  CHECK(max_speed <= limits.travel.speed_per_s * rounding);
  CHECK(max_push <= limits.travel.acceleration_per_s2 * rounding);
  CHECK(max_turn > 0.7);
  CHECK(max_turn <= limits.turning.speed_per_s * rounding);
  CHECK(max_twist <= limits.turning.acceleration_per_s2 * rounding);
  CHECK(max_lie <= limits.turning.acceleration_per_s2 * dt_s);
  CHECK(max_duration_s < 12.0);
}

TEST_CASE("a goal that comes again, or lies ahead on the same line, costs no time") {
  ToolMotion motion;
  motion.start({Vector3::Zero(), Vector3::UnitZ()});
  const ToolPose goal = {Vector3(0.3, 0.1, 0.0), Vector3(1.0, 0.0, 1.0).normalized()};
  REQUIRE(motion.plan(0.0, goal, {}));
  const double duration_s = motion.duration_s();
  REQUIRE(motion.plan(0.4 * duration_s, goal, {}));
  CHECK(motion.duration_s() == doctest::Approx(0.6 * duration_s).epsilon(0.02));
}

TEST_CASE("a goal without a direction is refused") {
  ToolMotion motion;
  motion.start({});
  CHECK_FALSE(motion.plan(0.0, {Vector3::Zero(), Vector3::Zero()}, {}));
  CHECK_FALSE(motion.plan(0.0, {Vector3(std::nan(""), 0.0, 0.0), Vector3::UnitZ()}, {}));
}
