// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/control/arm_controller.hpp"
#include "tuina/core/arm.hpp"

namespace tuina::motion {

/// A path of the plan made ready for one arm: where the tool goes through the air before it, and
/// the joint angles by which the arm reaches it. A job without a path only travels.
struct ArmJob {
  int path = -1;
  int step = 0;  ///< jobs of one step run together; the next step waits for all of them
  std::vector<control::ToolPose> way_in_base;
  JointVector posture_rad;
  JointVector from_rad = {};  ///< how it stands before it leaves its parking place; else empty
};

}  // namespace tuina::motion
