// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"

namespace tuina::robot {

/// Least and largest angle of each joint of an arm.
struct JointEnds {
  JointVector min_rad, max_rad;
};
[[nodiscard]] inline JointEnds joint_ends(const ArmModel& model) noexcept {
  JointEnds ends{.min_rad = JointVector::Zero(model.joints()),
                 .max_rad = JointVector::Zero(model.joints())};
  for (int i = 0; i < model.joints(); ++i) {
    const Link& link = model.table().links[static_cast<std::size_t>(i)];
    ends.min_rad[i] = link.min_rad;
    ends.max_rad[i] = link.max_rad;
  }
  return ends;
}

}  // namespace tuina::robot
