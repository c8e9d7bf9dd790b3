// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/motion/arm_job.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/obstacle.hpp"

namespace tuina::motion {

/// A plan that two arms can carry out: which arm stands how for which path, and what the tools fly
/// through.
struct ReadyPlan {
  massage::Plan plan;  ///< without the paths that no posture reaches; its notes name them
  PerArm<std::vector<ArmJob>> jobs;
  PerArm<JointVector> ready_rad;  ///< before and after the massage
  double rail_m = 0.0;
  bool reachable = true;  ///< every path of the plan that was given
  double min_arm_distance_m =
      0.0;                  ///< between the surfaces of the arms, over all paths that run together
  robot::Clearances clear;  ///< of the arms, from couch and the robot's own body
};

/// Makes a plan ready for a robot: the linear base is placed, every path followed by inverse
/// kinematics, and the way through the air before each contact lifted clear of the back. Fails when
/// no path can be reached. A base that stands already stays at `rail_m`.
[[nodiscard]] Result<ReadyPlan> make_ready(massage::Plan plan, const body::BackSurface& back,
                                           const robot::RobotMount& mount,
                                           const PerArm<robot::ArmModel>& models,
                                           const Transform& base_from_couch, double standoff_m,
                                           std::optional<double> rail_m = std::nullopt);

}  // namespace tuina::motion
