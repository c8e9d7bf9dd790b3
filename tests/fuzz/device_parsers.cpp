// SPDX-License-Identifier: Apache-2.0
// What devices say: datagrams of armlink, packets of a motor, samples of a force sensor, frames of
// a camera; and the files that name the devices and tell of them.
#include <zlib.h>

#include <algorithm>

#include "armlink/armlink.h"
#include "tests/fuzz/parsers.hpp"
#include "tuina/hardware/armlink.hpp"
#include "tuina/hardware/camera_pixels.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/dynamixel.hpp"
#include "tuina/hardware/serial_port.hpp"
#include "tuina/hardware/wrist_stream.hpp"

namespace tuina::test {
namespace {

namespace armlink = hardware::armlink;

armlink::Bytes bytes_of(std::string_view content) {
  return std::as_bytes(std::span(content.data(), content.size()));
}

template <std::size_t size>
std::string text_of(const std::array<std::byte, size>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), size};
}

/// What was read is just what would be written.
template <typename T>
bool same(const armlink::Decoded<T>& decoded, std::string_view content) {
  if (decoded) demand(text_of(armlink::encode(*decoded)) == content, "what is read is written so");
  return decoded.has_value();
}

bool accepts_datagram(std::string_view content) {
  const armlink::Bytes bytes = bytes_of(content);
  const auto state = armlink::decode_state(bytes);
  if (state) demand(state->q_rad.allFinite() && state->q_rad.size() > 0, "joints are somewhere");
  return same(state, content) || same(armlink::decode_command(bytes), content) ||
         same(armlink::decode_hello(bytes), content) || same(armlink::decode_ask(bytes), content);
}

/// A spoilt datagram fails by its check sum, so the faults are put under a right one.
std::string mended(std::string_view content) {
  if (content.size() < armlink::ask_size) return std::string(content);
  std::string mended(content.substr(0, content.size() - 4));
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(mended.data()), mended.size()));
  for (unsigned i = 0; i < 4; ++i) mended.push_back(static_cast<char>(crc >> (8 * i)));
  return mended;
}

/// The header in C takes the commands that are taken in C++, and no others.
bool accepts_in_c(std::string_view content) {
  const std::string bytes = mended(content);
  const auto* in = reinterpret_cast<const std::uint8_t*>(bytes.data());
  armlink_command command = {};
  const bool read = armlink_kind(in, static_cast<int>(bytes.size())) == ARMLINK_COMMAND &&
                    armlink_read_command(in, &command) != 0;
  demand(read == armlink::decode_command(bytes_of(bytes)).has_value(), "C reads what C++ reads");
  return read;
}

bool accepts_device_file(std::string_view content) {
  const auto file = hardware::parse_device_file(content, "device.toml");
  if (!file) return false;
  const auto& wrists = file->wrists.of;
  demand(
      file->arms || file->driven_arms || wrists[0] || wrists[1] || file->camera || file->turntable,
      "a device is named");
  demand(!(file->arms && file->driven_arms), "arms are of one kind");
  for (const auto& wrist : wrists) {
    if (!wrist) continue;
    demand(wrist->counts_per_n.minCoeff() > 0.0 && wrist->counts_per_nm.minCoeff() > 0.0,
           "counts are positive");
    const Matrix3& turn = wrist->tool_from_sensor_turn;
    demand((turn * turn.transpose()).isIdentity(1e-6), "a sensor is turned");
  }
  if (file->camera) {
    demand(file->camera->address.starts_with('/'), "a camera has a path");
    demand(file->camera->turned_deg % 90 == 0, "a picture stays upright");
  }
  if (file->turntable) {
    const auto& speeds = hardware::serial_speeds();
    demand(std::find(speeds.begin(), speeds.end(), file->turntable->bits_per_s) != speeds.end(),
           "a line has a speed");
    demand(file->turntable->zero_count >= 0 && file->turntable->zero_count < 1024,
           "zero is a count");
  }
  if (!file->arms) return true;
  for (const hardware::ArmDevice& arm : file->arms->of) {
    const auto again = hardware::parse_udp_address(arm.address);
    demand(again && *again == arm.udp && arm.udp.of.sin_port != 0, "an arm has an address");
  }
  demand(!((*file->arms)[Arm::left].udp == (*file->arms)[Arm::right].udp), "and one of its own");
  return true;
}

/// Every packet that is found stands in the stream as it would be written, and none twice.
bool accepts_packets(std::string_view content) {
  namespace dxl = hardware::dynamixel;
  dxl::Reader reader;
  reader.add({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
  bool any = false;
  std::size_t from = 0;
  while (const auto packet = reader.next()) {
    const auto bytes = dxl::encode(*packet);
    from = content.find(std::string(bytes.begin(), bytes.end()), from);
    demand(from != std::string_view::npos, "a packet is what came");
    from += bytes.size();
    any = true;
  }
  return any;
}

/// Every sample that is found stands in the stream as a frame with its sum, one after the other.
bool accepts_hex(std::string_view content) {
  hardware::hex_serial::Reader reader;
  bool any = false;
  std::size_t from = 0;
  while (!content.empty()) {
    const auto room = reader.room();
    demand(!room.empty(), "a reader has room");
    const std::size_t size = std::min(room.size(), content.size());
    std::copy_n(content.begin(), size, room.begin());
    reader.took(size);
    const std::string_view all = content;
    content.remove_prefix(size);
    while (const auto sample = reader.next()) {
      demand(sample->sequence <= 0xFFFF && sample->status <= 0xFFFF, "numbers have 16 bits");
      for (const std::int32_t count : sample->counts)
        demand(count >= -32768 && count <= 32767, "counts have 16 bits");
      any = true;
    }
    from += all.size() - content.size();
    demand(reader.spoilt_bytes() <= from, "no more is spoilt than came");
  }
  return any;
}

/// One request is no record; a record is what stands there, big-endian.
bool accepts_rdt(std::string_view content) {
  const auto bytes = bytes_of(content);
  const auto sample = hardware::rdt::decode(bytes);
  demand(sample.has_value() == (content.size() == hardware::rdt::record_size),
         "a record has a size");
  if (!sample) return false;
  hardware::WristDevice device{.kind = hardware::WristDevice::Kind::ati_udp};
  hardware::WristStream stream(device);
  const bool taken = stream.take(*sample, 1.0);
  demand(taken == (stream.fault() == nullptr), "the first is new, or at fault");
  demand(stream.in_tool().force_n.allFinite(), "a force is a number");
  demand(!stream.take(*sample, 1.001), "and the same is not new again");
  return taken;
}

bool accepts_wrist_calibration(std::string_view content) {
  const auto calibration = hardware::parse_wrist_calibration(content, "wrist.toml");
  if (!calibration) return false;
  demand(calibration->mass_kg >= 0.0 && calibration->com_in_tool_m.allFinite(), "a tool weighs");
  demand(hardware::parse_wrist_calibration(to_toml(*calibration), "again").has_value(),
         "what is written is read");
  return true;
}

/// As YUYV of 8 x 4 pixels and as JPEG.
bool accepts_frame(std::string_view content) {
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
  bool any = false;
  for (const auto format : {hardware::PixelFormat::yuyv, hardware::PixelFormat::mjpeg}) {
    const auto picture = hardware::grey_picture(format, bytes, 8, 4);
    if (picture) demand(picture->data.size() == 32, "a picture is whole");
    any = any || picture.has_value();
  }
  return any;
}

/// Grey, 8 x 4 pixels.
std::string some_jpeg() {
  constexpr std::string_view digits =
      "ffd8ffe000104a46494600010100000100010000ffdb004300080606070605080707070909080a0c140d"
      "0c0b0b0c1912130f141d1a1f1e1d1a1c1c20242e2720222c231c1c2837292c30313434341f27393d3832"
      "3c2e333432ffc0000b080004000801011100ffc40014000100000000000000000000000000000006ffc4"
      "001810000203000000000000000000000000000001062381ffda0008010100003f000f024aac3fffd9";
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
  return bytes;
}

std::vector<std::string> some_packets() {
  const auto text = [](const hardware::dynamixel::Packet& packet) {
    const auto bytes = hardware::dynamixel::encode(packet);
    return std::string(bytes.begin(), bytes.end());
  };
  const std::string told = text({200, 0, {7, 1, 0, 0, 0, 0x12, 2, 0, 0, 1, 1, 2, 3, 4}});
  return {told, text({1, hardware::dynamixel::read, {36, 11}}) + text({1, 0, {}}) + told};
}

/// Two frames of a HEX with something between.
std::string some_hex() {
  const std::string frame("\xAA\x07\x08\x10\0\1\0\0\0\1\0\2\0\3\0\4\0\5\0\6\0\xDF", 22);
  return frame + "noise" + frame;
}

std::vector<std::string> some_datagrams() {
  const JointVector six = JointVector::LinSpaced(6, 0.5, 3.0);
  armlink::State state{.session = 3, .sequence = 9, .mode = armlink::Mode::torque, .time_s = 0.009};
  state.q_rad = state.dq_rad_per_s = state.tau_nm = six;
  armlink::Hello hello{.session = 3, .sequence = 1, .modes = 11, .cycle_us = 1000};
  hello.max_torque_nm = hello.max_speed_rad_per_s = hello.min_rad = hello.max_rad = six;
  hello.name[0] = 'a';
  return {text_of(armlink::encode(armlink::Ask{.session = 3, .sequence = 1})),
          text_of(armlink::encode(hello)), text_of(armlink::encode(state)),
          text_of(armlink::encode(armlink::Command{
              .session = 3, .sequence = 2, .mode = armlink::Mode::ready, .values = six}))};
}

}  // namespace

std::vector<Parser> device_parsers() {
  return {
      {"armlink", some_datagrams(),
       [](std::string_view content) { return accepts_datagram(mended(content)); }},
      {"armlink_in_c", {some_datagrams().back()}, accepts_in_c},
      {"dynamixel", some_packets(), accepts_packets},
      {"hex_serial", {some_hex()}, accepts_hex},
      {"rdt", {std::string(36, '\0'), std::string(12, '\0') + std::string(24, '\7')}, accepts_rdt},
      {"wrist.toml",
       {"[wrist]\nmass_kg = 0.2\ncom_mm = [1, 2, 3]\noffset_n = [1, 2, 3]\n"
        "offset_nm = [0.1, 0.2, 0.3]\n"},
       accepts_wrist_calibration},
      {"camera_frame", {std::string(64, 'y'), some_jpeg()}, accepts_frame},
      {"device.toml",
       {"[camera]\nkind = \"v4l2\"\naddress = \"/dev/video0\"\nformat = \"MJPG\"\n"
        "exposure_ms = 5\ngain = 3\nfocus = 40\nturned_deg = 90\nframes_per_s = 30\n"
        "[turntable]\nkind = \"board\"\naddress = \"/dev/ttyACM0\"\nbits_per_s = 500000\n"
        "servo = 1\nzero_count = 512\nreversed = true\n",
        "[arm.left]\nkind = \"armlink\"\naddress = \"127.0.0.1:7001\"\n"
        "[arm.right]\nkind = \"armlink\"\naddress = \"192.168.3.11:7002\"\n"
        "[wrist_sensor.left]\nkind = \"hex_serial\"\naddress = \"/dev/ttyACM1\"\n"
        "filter = \"150Hz\"\ncounts_per_n = [10, 10, 8]\ncounts_per_nm = [300, 300, 250]\n"
        "x = [0, 0, 1]\nz = [1, 0, 0]\nat_mm = [-60, 0, 0]\nzero_at_start = true\n"},
       accepts_device_file}};
}

}  // namespace tuina::test
