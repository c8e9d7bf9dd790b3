// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/robot/elbow_turn.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"

using namespace tuina;
using namespace tuina::robot;

TEST_CASE("the elbow turns from one side to the other while the tool stays where it is") {
  const RobotMount mount = mount_for(BodyPosture::sitting);
  for (const ArmTable& table : {thesis_arm(), load_robot("successor")->arm}) {
    const ArmModel left(table, mount, Arm::left);
    const JointVector ready = ready_posture(table, mount)[Arm::left];
    const auto postures = turn_elbow(left, 0.0, ready);
    const Transform tool = left.base_from_tool(ready, 0.0);
    const auto elbow = static_cast<std::size_t>(elbow_origin(table));
    double max_inward_m = 1.0, max_outward_m = -1.0;
    for (std::size_t i = 0; i < postures.size(); ++i) {
      const auto pose = left.kinematics(postures[i], 0.0);
      CHECK((pose.base_from_tool.translation() - tool.translation()).norm() < 0.3_mm);
      CHECK(pose.base_from_tool.linear().col(0).dot(tool.linear().col(0)) > 1.0 - 1e-5);
      CHECK(limit_room_rad(table, postures[i]) > 2.9_deg);
      if (i > 0) CHECK((postures[i] - postures[i - 1]).cwiseAbs().maxCoeff() < 12_deg);
      max_inward_m = std::min(max_inward_m, pose.origins_in_base[elbow].y());
      max_outward_m = std::max(max_outward_m, pose.origins_in_base[elbow].y());
    }
    CHECK(std::find(postures.begin(), postures.end(), ready) != postures.end());
    CHECK(max_outward_m - max_inward_m > 150_mm);
  }
}

TEST_CASE(
    "waiting arms hold their elbows outward, off the way of an arm that works in the middle") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const RobotMount mount = mount_for(position);
    const ArmModel left(thesis_arm(), mount, Arm::left);
    const auto pose = left.kinematics(ready_posture(thesis_arm(), mount)[Arm::left], 0.0);
    const auto elbow = static_cast<std::size_t>(elbow_origin(thesis_arm()));
    CHECK(pose.origins_in_base[elbow].y() > left.shoulder_in_base(0.0).y() + 0.1);
  }
}
