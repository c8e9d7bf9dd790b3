// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot_model.hpp"

namespace tuina::app {

/// So many ways to hold the tool, by the last three joints of an arm that else stays at `from_rad`:
/// the directions of gravity in the tool are as far from each other as the joints allow.
[[nodiscard]] std::vector<JointVector> ways_to_hold(const robot::ArmModel& arm,
                                                    const JointVector& from_rad, double rail_m,
                                                    int count);

/// The arm of a device file goes through twelve such ways by its own drives, and `table` gets a row
/// of each: how the tool stood by the arm's encoders, and what its sensor said in half a second of
/// rest. Nobody may be near. Fails with Fault::device where arm or sensor does, or where an arm
/// leaves its way.
[[nodiscard]] Result<void> record_wrist_poses(const std::filesystem::path& device_file, Arm arm,
                                              const robot::RobotPlacement& robot,
                                              const std::filesystem::path& table,
                                              const Progress& progress);

}  // namespace tuina::app
