// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/devices/device_scanner.hpp"

#include <fmt/format.h>

namespace tuina::app {

Result<DeviceScanner> open_scanner(const hardware::DeviceFile& devices,
                                   const scanner::CameraModel& pictures) {
  auto turntable = hardware::Ax12Turntable::open(*devices.turntable);
  if (!turntable) return tl::unexpected(turntable.error());
  auto camera = hardware::V4l2Camera::open(*devices.camera, pictures.width_px, pictures.height_px);
  if (!camera) return tl::unexpected(camera.error());
  return DeviceScanner{
      .camera = std::move(*camera),
      .turntable = std::move(*turntable),
      .called = fmt::format("{}, {}", devices.camera->address, devices.turntable->address)};
}

}  // namespace tuina::app
