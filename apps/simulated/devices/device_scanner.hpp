// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::app {

/// Camera and turntable of a real scanner.
struct DeviceScanner {
  std::unique_ptr<scanner::Camera> camera;
  std::unique_ptr<scanner::Turntable> turntable;
  std::string called;  ///< both addresses
};

/// The one place where the kind of a camera, and of a turntable, is chosen. Pictures are so large
/// after they were turned. Both fail with Fault::device, naming the device and what mends it.
[[nodiscard]] Result<std::unique_ptr<scanner::Camera>> open_camera(
    const hardware::CameraDevice& device, int width_px, int height_px);
[[nodiscard]] Result<std::unique_ptr<scanner::Turntable>> open_turntable(
    const hardware::TurntableDevice& device);

/// Both of them. Fails with Fault::device, too.
[[nodiscard]] Result<DeviceScanner> open_scanner(const hardware::DeviceFile& devices,
                                                 const scanner::CameraModel& pictures);

}  // namespace tuina::app
