// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/arm.hpp"
#include "tuina/core/result.hpp"
#include "tuina/hardware/can/drive_device.hpp"
#include "tuina/hardware/udp_socket.hpp"
#include "tuina/hardware/wrist_device.hpp"

namespace tuina::hardware {

/// One arm of a `device.toml`, kind "armlink".
struct ArmDevice {
  std::string address;  ///< as it stands there
  UdpAddress udp;
};

/// How a camera sends its pictures: one byte a pixel; two pixels in four bytes; JPEG.
enum class PixelFormat : std::uint8_t { grey, yuyv, mjpeg };

/// The camera of a scanner. What stays empty keeps the camera's own value.
struct CameraDevice {
  std::string address = "/dev/video0";
  PixelFormat format = PixelFormat::yuyv;
  std::optional<double> exposure_ms;
  std::optional<int> gain;
  std::optional<int> focus;
  int frames_per_s = 30;
  int turned_deg = 0;  ///< by which the picture has to be turned to the right: 0, 90, 180, 270
};

/// The yaw motor of a scanner, an AX-12A, and the laser's switch.
struct TurntableDevice {
  /// With the board of `firmware/scanner`; or a USB serial adapter, whose line DTR is the switch.
  enum class Kind : std::uint8_t { board, adapter };
  Kind kind = Kind::board;
  std::string address = "/dev/ttyACM0";
  int bits_per_s = 500'000;
  int servo = 1;          ///< id of the motor
  int zero_count = 512;   ///< of 0 to 1023, at yaw 0
  bool reversed = false;  ///< counts fall while the yaw rises
};

/// The devices that a session or a scan has, `--device FILE`: both arms, by armlink or by drives
/// on CAN; force sensors at their wrists; camera and turntable of the scanner. Each may be absent,
/// but not all.
struct DeviceFile {
  std::optional<PerArm<ArmDevice>> arms;         ///< by armlink
  std::optional<PerArm<DrivenArm>> driven_arms;  ///< by drives on CAN; never beside `arms`
  PerArm<std::optional<WristDevice>> wrists;
  std::optional<CameraDevice> camera;
  std::optional<TurntableDevice> turntable;
};

/// Fails with Fault::config and file, line, key and value of all that is wrong.
[[nodiscard]] Result<DeviceFile> parse_device_file(std::string_view text, std::string_view name);
/// The same of a file, and of the calibrations that it names, which stand beside it unless their
/// path says otherwise; fails with Fault::file where one cannot be read.
[[nodiscard]] Result<DeviceFile> read_device_file(const std::filesystem::path& file);

}  // namespace tuina::hardware
