// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/rollout.hpp"

#include <doctest/doctest.h>

#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;

TEST_CASE("a joint with less room than the springs at both its ends rests in its middle") {
  const robot::RobotPlacement placement =
      robot::place_robot(robot::load_robot("thesis").value(), BodyPosture::prone);
  robot::ArmTable table = placement.arm;
  const JointVector ready_rad = robot::ready_posture(table, placement.mount)[Arm::left];
  for (const double room_rad : {0.05, 0.005}) {
    CAPTURE(room_rad);
    for (int i = 0; i < table.joints; ++i) {
      robot::Link& link = table.links[static_cast<std::size_t>(i)];
      link.min_rad = ready_rad[i] - room_rad;
      link.max_rad = ready_rad[i] + room_rad;
    }
    const robot::ArmModel model(table, placement.mount, Arm::left);
    motion::Rollout rollout(model, 0.0, ready_rad, 0.3);
    motion::JointPath passed;
    rollout.settle(ready_rad, passed);
    CHECK((rollout.q_rad() - ready_rad).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(passed.limit_excess_rad < 1e-9);
  }
}
