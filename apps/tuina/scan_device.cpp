// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/scan_device.hpp"

#include <array>

#include "tuina/hardware/ax12_turntable.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

void add_finding(const char* what, const std::string& address, const std::string& finding,
                 bool good, ordered_json& all, Answer& answer) {
  answer.text +=
      good || finding.starts_with(address)
          ? fmt::format("{} {:<18} {}\n", good ? "ok  " : "none", what, finding)
          : fmt::format("{} {:<18} {}: {}\n", good ? "ok  " : "none", what, address, finding);
  all.push_back({{"device", what}, {"address", address}, {"good", good}, {"finding", finding}});
  if (!good) answer.exit_code = 3;
}

}  // namespace

Result<hardware::DeviceFile> scanner_devices(const std::string& device_file,
                                             const std::string& camera,
                                             const std::string& turntable) {
  if (device_file.empty()) {
    if (camera.empty() || turntable.empty())
      return fail(Fault::usage,
                  "--camera and --turntable belong together, as /dev/video0 and /dev/ttyACM0");
    return hardware::DeviceFile{.arms = {},
                                .camera = hardware::CameraDevice{.address = camera},
                                .turntable = hardware::TurntableDevice{.address = turntable}};
  }
  auto file = hardware::read_device_file(device_file);
  if (!file) return file;
  if (file->camera && file->turntable) return file;
  return fail(Fault::config, "{}: a scan needs [camera] and [turntable]; [{}] is missing",
              device_file, file->camera ? "turntable" : "camera");
}

Result<hardware::CameraMode> picture_mode(const hardware::CameraDevice& camera) {
  constexpr std::array formats = {"GREY", "YUYV", "MJPG"};
  constexpr int max_width_px = 1280;
  const char* wanted = formats.at(static_cast<std::size_t>(camera.format));
  const auto listed = hardware::list_camera(camera.address);
  if (!listed) return tl::unexpected(listed.error());
  for (const hardware::CameraMode& mode : listed->modes)
    if (mode.format == wanted && mode.width_px <= max_width_px) return mode;
  return fail(Fault::device, "{}: offers no mode {}; see `tuina camera`", camera.address, wanted);
}

void ask_scanner(const hardware::DeviceFile& devices, ordered_json& all, Answer& answer) {
  if (devices.camera) {
    const std::string& address = devices.camera->address;
    const auto found = hardware::list_camera(address);
    add_finding("camera", address,
                found ? fmt::format("{}: {}, {} modes", address, found->name, found->modes.size())
                      : found.error().message,
                found.has_value(), all, answer);
  }
  if (devices.turntable) {
    const std::string& address = devices.turntable->address;
    const auto found = hardware::Ax12Turntable::open(*devices.turntable);
    add_finding("turntable", address,
                found ? fmt::format("{}: {}", address, (*found)->who()) : found.error().message,
                found.has_value(), all, answer);
  }
}

}  // namespace tuina::app
