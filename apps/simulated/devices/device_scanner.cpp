// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/devices/device_scanner.hpp"

#include <fmt/format.h>

#include "tuina/hardware/ax12_turntable.hpp"
#include "tuina/hardware/v4l2_camera.hpp"

namespace tuina::app {

Result<std::unique_ptr<scanner::Camera>> open_camera(const hardware::CameraDevice& device,
                                                     int width_px, int height_px) {
  return hardware::V4l2Camera::open(device, width_px, height_px);
}

Result<std::unique_ptr<scanner::Turntable>> open_turntable(
    const hardware::TurntableDevice& device) {
  return hardware::Ax12Turntable::open(device);
}

Result<DeviceScanner> open_scanner(const hardware::DeviceFile& devices,
                                   const scanner::CameraModel& pictures) {
  auto turntable = open_turntable(*devices.turntable);
  if (!turntable) return tl::unexpected(turntable.error());
  auto camera = open_camera(*devices.camera, pictures.width_px, pictures.height_px);
  if (!camera) return tl::unexpected(camera.error());
  return DeviceScanner{
      .camera = std::move(*camera),
      .turntable = std::move(*turntable),
      .called = fmt::format("{}, {}", devices.camera->address, devices.turntable->address)};
}

}  // namespace tuina::app
