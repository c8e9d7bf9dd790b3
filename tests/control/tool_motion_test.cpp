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

TEST_CASE("a goal without a direction is refused") {
  ToolMotion motion;
  motion.start({});
  CHECK_FALSE(motion.plan(0.0, {Vector3::Zero(), Vector3::Zero()}, {}));
  CHECK_FALSE(motion.plan(0.0, {Vector3(std::nan(""), 0.0, 0.0), Vector3::UnitZ()}, {}));
}
