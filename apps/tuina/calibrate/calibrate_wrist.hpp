// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "apps/cli/command_line.hpp"

namespace tuina::app {

/// `tuina calibrate --wrist`: weight, centre and offset from a table of poses, written to `out`.
[[nodiscard]] Result<Answer> calibrate_wrist(const std::filesystem::path& poses,
                                             const std::filesystem::path& out);

}  // namespace tuina::app
