// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "apps/cli/command_line.hpp"

namespace tuina::app {

/// `tuina calibrate --capture`: leads through the pictures of a set with the scanner of the device
/// file, into a folder that has `board.toml`. What to do is told on the terminal.
[[nodiscard]] Result<Answer> calibrate_capture(const std::filesystem::path& folder,
                                               const std::string& device_file, int poses,
                                               bool quiet);

}  // namespace tuina::app
