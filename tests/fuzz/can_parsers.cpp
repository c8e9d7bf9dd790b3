// SPDX-License-Identifier: Apache-2.0
// Drives on CAN: what they send, and the file that names them.
#include <algorithm>
#include <cmath>

#include "tests/fuzz/parsers.hpp"
#include "tuina/hardware/can/drive.hpp"
#include "tuina/hardware/device_file.hpp"

namespace tuina::test {
namespace {

namespace canopen = hardware::canopen;

/// Frames of a CAN bus, as the kernel hands them over: what is read is written so, and a drive that
/// takes whatever comes stays a number or says what is wrong.
bool accepts_can(std::string_view content) {
  const hardware::DriveDevice device{
      .bus = "can0", .node = 4, .counts_per_turn = 4096, .rated_torque_nm = 1.0};
  hardware::Drive drive(device, 1.0, "the left elbow");
  bool any = false;
  for (; content.size() >= sizeof(can_frame); content.remove_prefix(sizeof(can_frame))) {
    can_frame frame = {};
    std::copy_n(content.begin(), sizeof frame, reinterpret_cast<char*>(&frame));
    frame.can_dlc = std::min<std::uint8_t>(frame.can_dlc, CAN_MAX_DLEN);  // as the kernel holds it
    const canopen::Address from = canopen::address_of(frame);
    demand(from.node <= canopen::max_node, "a node has a number");
    const auto same = [&](const can_frame& written) {
      demand(written.can_id == frame.can_id && written.can_dlc == frame.can_dlc, "whose it is");
      any = true;
      return std::equal(written.data, written.data + written.can_dlc, frame.data);
    };
    if (const auto state = canopen::heartbeat_of(frame))
      demand(same(canopen::heartbeat(from.node, *state)), "a heartbeat is written so");
    if (const auto answer = canopen::answer_of(frame)) {
      const auto again = canopen::answer_of(canopen::encode(from.node, *answer));
      demand(again && again->value == answer->value && again->kind == answer->kind,
             "an answer is read as it is written");
    }
    if (from.kind == canopen::Kind::told)
      if (const auto told = hardware::cia402::told_of(frame))
        demand(same(hardware::cia402::encode(from.node, *told)), "what is told is written so");
    drive.begin_cycle(1);
    drive.take(frame);
    demand(std::isfinite(drive.q_rad()) && std::isfinite(drive.dq_rad_per_s()), "a joint is there");
    demand(drive.order(0.5, false).can_dlc == 4, "an order has a size");
  }
  return any;
}

/// A drive tells, answers, beats and reports.
std::string some_can() {
  can_frame emergency = canopen::frame_for(canopen::Kind::emergency, 4, 8);
  canopen::put(emergency, 0, 2, 0x8611);
  std::string bytes;
  for (const can_frame& frame :
       {canopen::heartbeat(4, canopen::NodeState::operational),
        hardware::cia402::encode(4, hardware::cia402::Told{0x1637, -5000, 120}),
        canopen::encode(4, {canopen::Answer::Kind::written, 0x6060, 0, 0, 0}),
        canopen::encode(4, {canopen::Answer::Kind::refused, 0x6060, 0, 0, 0x06090030}),
        canopen::encode(4, {canopen::Answer::Kind::read, 0x6064, 0, 4, 3389}), emergency})
    bytes.append(reinterpret_cast<const char*>(&frame), sizeof frame);
  return bytes;
}

bool accepts_driven_arms(std::string_view content) {
  const auto file = hardware::parse_device_file(content, "device.toml");
  if (!file || !file->driven_arms) return false;
  demand(!file->arms, "arms are of one kind");
  for (const auto& wrist : file->wrists.of) demand(wrist.has_value(), "drives feel nothing");
  for (const hardware::BusLoad& load : hardware::bus_loads(*file->driven_arms))
    demand(load.drives > 0 && load.share <= 1.0, "a bus bears what it carries");
  for (const hardware::DrivenArm& arm : file->driven_arms->of) {
    demand(!arm.joints.empty() && arm.joints.size() <= max_joints, "an arm has joints");
    for (const hardware::DriveDevice& drive : arm.joints)
      demand(drive.node > 0 && drive.node < canopen::host_node && drive.counts_per_rad() != 0.0 &&
                 drive.rated_torque_at_joint_nm() != 0.0,
             "a drive has a node and a scale");
  }
  return true;
}

std::string some_driven_arms() {
  std::string text;
  int i = 0;
  for (const char* arm : {"left", "right"}) {
    text += fmt::format(
        "[arm.{0}]\nkind = \"cia402\"\nbits_per_s = 1000000\n[[arm.{0}.joint]]\nbus = \"can{1}\"\n"
        "node = {2}\ncounts_per_turn = 4096\ngear = 100\nrated_torque_nm = 0.6\nzero_count = -7\n"
        "reversed = true\n[wrist_sensor.{0}]\nkind = \"ati_udp\"\n"
        "address = \"192.168.1.{2}:49152\"\ncounts_per_n = [1, 1, 1]\ncounts_per_nm = [1, 1, 1]\n"
        "x = [1, 0, 0]\nz = [0, 0, 1]\nat_mm = [0, 0, 0]\n",
        arm, i, i + 1);
    ++i;
  }
  return text;
}

}  // namespace

std::vector<Parser> can_parsers() {
  return {{"can", {some_can()}, accepts_can},
          {"driven_arms", {some_driven_arms()}, accepts_driven_arms}};
}

}  // namespace tuina::test
