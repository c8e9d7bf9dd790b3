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

/// A plan with the jobs of both arms: configurations and free-space transfers.
struct ReadyPlan {
  massage::Plan plan;  ///< without unreachable paths; its notes name them
  PerArm<std::vector<ArmJob>> jobs;
  PerArm<JointVector> ready_rad;  ///< configuration before and after the massage
  double rail_m = 0.0;
  bool reachable = true;            ///< true when no path was left out
  double min_arm_distance_m = 0.0;  ///< minimum over all paths that run together
  robot::Clearances clear;          ///< minimum distances of the arms from couch and robot body
};

/// Places the linear base, solves inverse kinematics along every path and plans collision-free
/// transfers between contacts. Where the arm is felt as heavy, forces are lowered to what
/// `max_pressing_n` allows, and notes say so. Fails when no path can be reached. With `rail_m` the
/// base stays there.
[[nodiscard]] Result<ReadyPlan> make_ready(massage::Plan plan, const body::BackSurface& back,
                                           const robot::RobotMount& mount,
                                           const PerArm<robot::ArmModel>& models,
                                           const Transform& base_from_couch, double standoff_m,
                                           std::optional<double> rail_m = std::nullopt);

}  // namespace tuina::motion
