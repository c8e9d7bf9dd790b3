// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "apps/cli/command_line.hpp"
#include "tuina/core/acupoint.hpp"

namespace tuina::app {

/// `tuina calibrate --robot`: where the robot stands, from the touches in touches.csv of `folder`,
/// written to `out`.
[[nodiscard]] Result<Answer> calibrate_robot(const std::filesystem::path& folder,
                                             const std::string& robot, BodyPosture position,
                                             const std::filesystem::path& out);

/// Has the simulated robot touch a board, and writes touches.csv into this new folder.
[[nodiscard]] Result<Answer> rehearse_robot(const std::filesystem::path& folder,
                                            const std::string& robot, BodyPosture position,
                                            std::uint64_t seed);

}  // namespace tuina::app
