// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/device_file.hpp"

#include <algorithm>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/hardware/serial_port.hpp"

namespace tuina::hardware {
namespace {

void read_armlink(const TomlTable& section, Arm arm, PerArm<ArmDevice>& arms) {
  section.only({}, {"kind", "address"});
  arms[arm].address = section.text("address").value_or("");
  const auto address = parse_udp_address(arms[arm].address);
  if (!address && section.has("address"))
    section.wrong("address", "is no IPv4 address and port, such as \"192.168.3.10:7001\"");
  arms[arm].udp = address.value_or(UdpAddress{});
  const bool both_known = address && arm == Arm::right && arms[Arm::left].udp.of.sin_port;
  if (both_known && *address == arms[Arm::left].udp)
    section.wrong("address", "is that of the left arm; each arm has an address of its own");
}

/// Both arms are of one kind.
void read_arms(const TomlTable& table, DeviceFile& file) {
  table.only({}, {"left", "right"});
  for (const Arm arm : both_arms) {
    const auto section = table.table(name_of(arm));
    if (!section) continue;
    const bool driven = section->word("kind", {"armlink", "cia402"}) == std::size_t{1};
    if (arm == Arm::right && (driven ? file.arms.has_value() : file.driven_arms.has_value()))
      section->wrong("kind", "is not that of the left arm; both are of one kind");
    if (driven) {
      if (!file.driven_arms) file.driven_arms.emplace();
      (*file.driven_arms)[arm] = read_driven_arm(*section);
    } else {
      if (!file.arms) file.arms.emplace();
      read_armlink(*section, arm, *file.arms);
    }
  }
  if (!file.driven_arms) return;
  if (const std::string fault = fault_of(*file.driven_arms); !fault.empty())
    table.reject("left", fault);
}

PerArm<std::optional<WristDevice>> read_wrists(const TomlTable& table) {
  PerArm<std::optional<WristDevice>> wrists;
  table.only({"left", "right"});
  for (const Arm arm : both_arms)
    if (const auto section = table.table(name_of(arm))) wrists[arm] = read_wrist_device(*section);
  if (table.keys().empty())
    table.reject("left", "no wrist sensor is named: [wrist_sensor.left], [wrist_sensor.right]");
  const auto& right = table.table("right");
  if (right && wrists[Arm::left] && wrists[Arm::left]->address == wrists[Arm::right]->address &&
      right->has("address"))
    right->wrong("address", "is that of the left sensor; each has an address of its own");
  return wrists;
}

/// The path of a device, as the kernel names it.
void read_path(const TomlTable& table, std::string& address) {
  address = table.text("address").value_or(address);
  if (table.has("address") && !address.starts_with('/'))
    table.wrong("address", "is no path of a device, such as \"/dev/video0\" or \"/dev/ttyACM0\"");
}

CameraDevice read_camera(const TomlTable& table) {
  CameraDevice camera;
  table.only({"format", "exposure_ms", "gain", "focus", "frames_per_s", "turned_deg"},
             {"kind", "address"});
  (void)table.word("kind", {"v4l2"});
  read_path(table, camera.address);
  camera.format = static_cast<PixelFormat>(table.word("format", {"GREY", "YUYV", "MJPG"})
                                               .value_or(static_cast<std::size_t>(camera.format)));
  camera.exposure_ms = table.number("exposure_ms", 0.1, 33.0);
  camera.gain = table.whole("gain", 0, 100'000);
  camera.focus = table.whole("focus", 0, 100'000);
  camera.frames_per_s = table.whole("frames_per_s", 5, 240).value_or(camera.frames_per_s);
  camera.turned_deg = table.whole("turned_deg", 0, 270).value_or(0);
  if (camera.turned_deg % 90 != 0) table.wrong("turned_deg", "is not 0, 90, 180 or 270");
  return camera;
}

TurntableDevice read_turntable(const TomlTable& table) {
  TurntableDevice turntable;
  table.only({"bits_per_s", "servo", "zero_count", "reversed"}, {"kind", "address"});
  const bool adapter = table.word("kind", {"board", "adapter"}) == std::size_t{1};
  turntable.kind = adapter ? TurntableDevice::Kind::adapter : TurntableDevice::Kind::board;
  read_path(table, turntable.address);
  // An AX-12A leaves its factory with 1 Mbit/s; the board speaks to its host at half of that.
  turntable.bits_per_s =
      table.whole("bits_per_s", 0, 10'000'000).value_or(adapter ? 1'000'000 : 500'000);
  const auto& speeds = serial_speeds();
  if (std::find(speeds.begin(), speeds.end(), turntable.bits_per_s) == speeds.end())
    table.wrong("bits_per_s", fmt::format("is not one of {}", fmt::join(speeds, ", ")));
  turntable.servo = table.whole("servo", 0, 199).value_or(turntable.servo);
  turntable.zero_count = table.whole("zero_count", 0, 1023).value_or(turntable.zero_count);
  turntable.reversed = table.flag("reversed").value_or(false);
  return turntable;
}

}  // namespace

Result<DeviceFile> parse_device_file(std::string_view text, std::string_view name) {
  DeviceFile file;
  const auto read = read_toml(text, name, Fault::config, [&](const TomlTable& root) {
    root.only({"arm", "wrist_sensor", "camera", "turntable"});
    if (const auto arms = root.table("arm")) read_arms(*arms, file);
    if (const auto wrists = root.table("wrist_sensor")) file.wrists = read_wrists(*wrists);
    if (const auto camera = root.table("camera")) file.camera = read_camera(*camera);
    if (const auto turntable = root.table("turntable")) file.turntable = read_turntable(*turntable);
    if (file.driven_arms && !(file.wrists[Arm::left] && file.wrists[Arm::right]))
      root.reject("arm",
                  "drives on CAN feel no contact: [wrist_sensor.left] and [wrist_sensor.right] are "
                  "needed beside them");
    if (root.keys().empty())
      root.reject("arm",
                  "no device is named: [arm.left] and [arm.right], [wrist_sensor.left], "
                  "[wrist_sensor.right], [camera], [turntable]");
  });
  if (!read) return tl::unexpected(read.error());
  return file;
}

Result<DeviceFile> read_device_file(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  auto devices = parse_device_file(*text, file.string());
  if (!devices) return devices;
  for (std::optional<WristDevice>& wrist : devices->wrists.of) {
    if (!wrist || wrist->calibration_file.empty()) continue;
    const std::filesystem::path beside = file.parent_path() / wrist->calibration_file;
    const auto content = read_file(beside, max_bytes);
    if (!content) return tl::unexpected(content.error());
    auto calibration = parse_wrist_calibration(*content, beside.string());
    if (!calibration) return tl::unexpected(calibration.error());
    wrist->calibration = *calibration;
  }
  return devices;
}

}  // namespace tuina::hardware
