// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/arm_controller.hpp"

namespace tuina::control {

inline const robot::ArmModel model(robot::thesis_arm(), robot::mount_for(BodyPosture::sitting),
                                   Arm::left);

inline JointVector bent() {
  JointVector q(6);
  q << -0.3, -0.2, 0.1, 0.4, 0.1, -0.2;
  return q;
}

/// At rest there.
inline ArmState at_rest(const JointVector& q) {
  return {.q_rad = q,
          .dq_rad_per_s = JointVector::Zero(6),
          .base_from_tool = model.base_from_tool(q, 0.0)};
}

inline ToolPose tip_pose(const JointVector& q) {
  const Transform tool = model.base_from_tool(q, 0.0);
  const Vector3 normal = tool_normal(tool);
  return {tool.translation() - model.table().tool_radius_m * normal, normal};
}

/// Begun in `bent`, without learning friction.
inline ArmController still_controller() {
  ArmController::Options options;
  options.learn_s = 0.0;
  ArmController controller(model, options);
  controller.start(at_rest(bent()));
  return controller;
}

}  // namespace tuina::control
