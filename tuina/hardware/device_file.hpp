// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/arm.hpp"
#include "tuina/core/result.hpp"
#include "tuina/hardware/udp_socket.hpp"

namespace tuina::hardware {

/// One arm of a `device.toml`.
struct ArmDevice {
  std::string address;  ///< as it stands there
  UdpAddress udp;
};

/// Which devices a session has, `--device FILE`: both arms, by armlink.
struct DeviceFile {
  PerArm<ArmDevice> arms;
};

/// Fails with Fault::config and file, line, key and value of all that is wrong.
[[nodiscard]] Result<DeviceFile> parse_device_file(std::string_view text, std::string_view name);
/// The same of a file; fails with Fault::file where it cannot be read.
[[nodiscard]] Result<DeviceFile> read_device_file(const std::filesystem::path& file);

}  // namespace tuina::hardware
