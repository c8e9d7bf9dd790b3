// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "apps/cli/command_line.hpp"
#include "apps/serve/live_picture.hpp"

namespace tuina::app {

/// `tuina calibrate --capture`: leads through the pictures of a set with the scanner of the device
/// file, into a folder that has `board.toml`. What to do is told on the terminal, and on the page
/// where one was asked for.
[[nodiscard]] Result<Answer> calibrate_capture(const std::filesystem::path& folder,
                                               const std::string& device_file, int poses,
                                               LivePicture& live, bool quiet);

}  // namespace tuina::app
