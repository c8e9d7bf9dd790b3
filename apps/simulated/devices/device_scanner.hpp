// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/hardware/ax12_turntable.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/v4l2_camera.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::app {

/// Camera and turntable of a real scanner.
struct DeviceScanner {
  std::unique_ptr<hardware::V4l2Camera> camera;
  std::unique_ptr<hardware::Ax12Turntable> turntable;
  std::string called;  ///< both addresses
};

/// Fails with Fault::device, naming the device and what mends it.
[[nodiscard]] Result<DeviceScanner> open_scanner(const hardware::DeviceFile& devices,
                                                 const scanner::CameraModel& pictures);

}  // namespace tuina::app
