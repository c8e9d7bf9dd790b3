// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/control/arm_controller.hpp"
#include "tuina/core/arm.hpp"

namespace tuina::motion {

/// One job of an arm: a transfer through free space, then one path of the plan with the joint
/// configuration that reaches it. Without a path (-1) the arm only travels.
struct ArmJob {
  int path = -1;
  int step = 0;  ///< jobs of one step run together; the next step waits for all of them
  std::vector<control::ToolPose> waypoints_in_base;
  JointVector posture_rad;
  JointVector from_rad = {};  ///< configuration before leaving the parking place; empty otherwise
};

}  // namespace tuina::motion
