// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/calibration/board/views.hpp"

namespace tuina::calibration {

/// Joins poses that show the board in one place, by the corners that both have at one yaw: counted
/// twice, they would make the result look surer than it is. Of their pictures at one yaw one stays,
/// if possible one with a laser line. Returns what is said of them.
[[nodiscard]] std::vector<std::string> join_repeats(Views& views);

}  // namespace tuina::calibration
