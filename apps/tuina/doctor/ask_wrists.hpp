// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "tuina/hardware/device_file.hpp"

namespace tuina::app {

/// For `tuina doctor`: who the wrist sensors of the file are, and what they say in a second and a
/// half with nothing at the tool: rate, gaps, noise, drift, and the mean wrench at the tool without
/// the offset of a calibration, which is a row for `tuina calibrate --wrist`.
void ask_wrists(const hardware::DeviceFile& devices, nlohmann::ordered_json& all, Answer& answer);

}  // namespace tuina::app
