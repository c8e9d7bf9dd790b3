// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tuina/core/io/toml_reader.hpp"
#include "tuina/hardware/udp_socket.hpp"
#include "tuina/hardware/wrist_calibration.hpp"

namespace tuina::hardware {

/// A force sensor between an arm's last link and its tool, `[wrist_sensor.left]` of a device file.
struct WristDevice {
  /// How the sensor is connected and speaks.
  enum class Kind : std::uint8_t {
    hex_serial,  ///< OptoForce HEX at its USB box
    hex_udp,     ///< OptoForce or OnRobot HEX at its Ethernet box
    ati_udp,     ///< ATI Net F/T or Axia
  };
  Kind kind = Kind::hex_serial;
  std::string address;  ///< as it stands in the file
  UdpAddress udp;       ///< of one with Ethernet
  int rate_hz = 1000;
  std::uint8_t filter = 0;  ///< 0 none, 1 to 6 for 500, 150, 50, 15, 5 and 1.5 Hz; HEX only
  Vector3 counts_per_n = Vector3::Ones();
  Vector3 counts_per_nm = Vector3::Ones();
  Matrix3 tool_from_sensor_turn = Matrix3::Identity();
  Vector3 sensor_in_tool_m = Vector3::Zero();  ///< origin of the sensor's axes
  bool reversed = false;                       ///< it says what the tool does to the environment
  bool zero_at_start = false;                  ///< with nothing at the tool, before each session
  std::string calibration_file;
  std::optional<WristCalibration> calibration;
};

/// Reads one sensor's section; what is wrong is collected in the table's faults.
[[nodiscard]] WristDevice read_wrist_device(const TomlTable& table);

}  // namespace tuina::hardware
