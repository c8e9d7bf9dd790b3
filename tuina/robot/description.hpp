// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"

namespace tuina::robot {

/// The whole robot, linear base and both arms, as MJCF for MuJoCo in the `base` frame: joints
/// `rail`, `left_elbow`, ...; motors of the same names in newton metres (the rail: newtons); sites
/// `left_tool` and `right_tool` at the centres of the spheres, turned as the tool frame. Collisions
/// are off: what the arms touch is the caller's. The rail's dry mass is that of column and
/// controllers.
[[nodiscard]] std::string to_mjcf(const RobotMount& mount, const PerArm<ArmTable>& tables,
                                  double timestep_s, double column_kg = 60.0);

}  // namespace tuina::robot
