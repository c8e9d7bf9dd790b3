// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tuina/robot/robot_model.hpp"

namespace tuina::robot {

/// Reads the table of a robot, TOML; docs/robot.md names the keys. Refused, all faults together:
/// unknown and missing keys, numbers out of their ranges, arms of other than six or seven joints,
/// names twice, inertias that no solid has, directions that are not at right angles.
[[nodiscard]] Result<RobotModel> parse_robot(std::string_view text, std::string_view name);

/// The same table as text; read again it gives the same numbers.
[[nodiscard]] std::string to_toml(const RobotModel& model);

}  // namespace tuina::robot
