// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/cli/command_line.hpp"
#include "apps/simulated/devices/device_scanner.hpp"
#include "tuina/hardware/video_device.hpp"

namespace tuina::app {

/// The scanner of a device file, or of two addresses where there is none. Fails with Fault::usage
/// or Fault::config where one of the two is not named.
[[nodiscard]] Result<hardware::DeviceFile> scanner_devices(const std::string& device_file,
                                                           const std::string& camera,
                                                           const std::string& turntable);

/// The first mode in the camera's list with the format that the file wants and pictures of at most
/// 1280 pixels across. Fails with Fault::device where there is none.
[[nodiscard]] Result<hardware::CameraMode> picture_mode(const hardware::CameraDevice& camera);

/// For `tuina doctor`: whether camera and turntable of the file answer, and who they are. Nothing
/// moves, and the laser stays dark.
void ask_scanner(const hardware::DeviceFile& devices, nlohmann::ordered_json& all, Answer& answer);

}  // namespace tuina::app
