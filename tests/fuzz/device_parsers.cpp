// SPDX-License-Identifier: Apache-2.0
// What devices say: datagrams of armlink, and the file that names the devices.
#include <zlib.h>

#include "tests/fuzz/parsers.hpp"
#include "tuina/hardware/armlink.hpp"
#include "tuina/hardware/device_file.hpp"

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
bool accepts_mended(std::string_view content) {
  if (content.size() < armlink::ask_size) return accepts_datagram(content);
  std::string mended(content.substr(0, content.size() - 4));
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(mended.data()), mended.size()));
  for (unsigned i = 0; i < 4; ++i) mended.push_back(static_cast<char>(crc >> (8 * i)));
  return accepts_datagram(mended);
}

bool accepts_device_file(std::string_view content) {
  const auto file = hardware::parse_device_file(content, "device.toml");
  if (!file) return false;
  for (const hardware::ArmDevice& arm : file->arms.of) {
    const auto again = hardware::parse_udp_address(arm.address);
    demand(again && *again == arm.udp && arm.udp.of.sin_port != 0, "an arm has an address");
  }
  demand(!(file->arms[Arm::left].udp == file->arms[Arm::right].udp), "and one of its own");
  return true;
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
  return {{"armlink", some_datagrams(), accepts_mended},
          {"device.toml",
           {"[arm.left]\nkind = \"armlink\"\naddress = \"127.0.0.1:7001\"\n"
            "[arm.right]\nkind = \"armlink\"\naddress = \"192.168.3.11:7002\"\n"},
           accepts_device_file}};
}

}  // namespace tuina::test
