// SPDX-License-Identifier: Apache-2.0
// Frames of CANopen as drives of several makers have them, and what a bus can carry.
#include "tuina/hardware/can/canopen.hpp"

#include <doctest/doctest.h>

#include "tests/reason.hpp"
#include "tuina/hardware/can/cia402.hpp"
#include "tuina/hardware/device_file.hpp"

using namespace tuina;
using namespace tuina::hardware;

namespace {

can_frame frame(canid_t id, std::initializer_list<std::uint8_t> bytes) {
  can_frame made = {};
  made.can_id = id;
  for (const std::uint8_t byte : bytes) made.data[made.can_dlc++] = byte;
  return made;
}

void check_same(const can_frame& one, const can_frame& other) {
  CHECK(one.can_id == other.can_id);
  REQUIRE(one.can_dlc == other.can_dlc);
  for (int i = 0; i < one.can_dlc; ++i) CHECK(one.data[i] == other.data[i]);
}

std::string drive(const char* bus, int node) {
  return fmt::format(
      "[[arm.{{0}}.joint]]\nbus = \"{}\"\nnode = {}\ncounts_per_turn = 4096\ngear = 100\n"
      "rated_torque_nm = 0.6\n",
      bus, node);
}

/// Both arms, each with these drives; the right arm's buses are others.
Result<DeviceFile> file_of(const std::vector<std::pair<int, int>>& drives, const char* more = "") {
  std::string text;
  for (const int side : {0, 1}) {
    const char* name = side == 0 ? "left" : "right";
    text += fmt::format("[arm.{}]\nkind = \"cia402\"\n{}", name, more);
    for (const auto& [bus, node] : drives)
      text += fmt::format(fmt::runtime(drive(fmt::format("can{}", bus + 2 * side).c_str(), node)),
                          name);
    text += fmt::format(
        "[wrist_sensor.{}]\nkind = \"ati_udp\"\naddress = \"192.168.1.{}:49152\"\n"
        "counts_per_n = [1, 1, 1]\ncounts_per_nm = [1, 1, 1]\nx = [1, 0, 0]\nz = [0, 0, 1]\n"
        "at_mm = [0, 0, 0]\n",
        name, side + 1);
  }
  return parse_device_file(text, "device.toml");
}

}  // namespace

// Lines of candump from drives of others: github.com/ros-industrial/ros_canopen, threads 259 and
// 380.
TEST_CASE("a host asks and sets as others do on real drives") {
  using canopen::Object;
  check_same(canopen::ask(9, Object{0x6077, 0, 2}),
             frame(0x609, {0x40, 0x77, 0x60, 0x00, 0x00, 0x00, 0x00, 0x00}));
  check_same(canopen::write(9, Object{0x1017, 0, 2}, 0),
             frame(0x609, {0x2B, 0x17, 0x10, 0x00, 0x00, 0x00, 0x00, 0x00}));
  check_same(canopen::write(3, Object{0x1A01, 1, 4}, 0x60640020),
             frame(0x603, {0x23, 0x01, 0x1A, 0x01, 0x20, 0x00, 0x64, 0x60}));
  check_same(canopen::write(3, Object{0x1801, 2, 1}, 1),
             frame(0x603, {0x2F, 0x01, 0x18, 0x02, 0x01, 0x00, 0x00, 0x00}));
  check_same(canopen::network(canopen::Network::stop, 9), frame(0x000, {0x02, 0x09}));
  check_same(canopen::sync(), frame(0x080, {}));
}

TEST_CASE("what real drives answer is read") {
  const auto position =
      canopen::answer_of(frame(0x583, {0x43, 0x64, 0x60, 0x00, 0x3D, 0x0D, 0x00, 0x00}));
  REQUIRE(position.has_value());
  CHECK(position->kind == canopen::Answer::Kind::read);
  CHECK(position->index == 0x6064);
  CHECK(position->value == 3389);
  const auto torque =
      canopen::answer_of(frame(0x589, {0x4B, 0x77, 0x60, 0x00, 0x00, 0x00, 0x00, 0x00}));
  REQUIRE(torque.has_value());
  CHECK(torque->bytes == 2);
  const auto set = canopen::answer_of(frame(0x589, {0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0}));
  REQUIRE(set.has_value());
  CHECK(set->kind == canopen::Answer::Kind::written);
  CHECK(canopen::heartbeat_of(frame(0x709, {0x05})) == canopen::NodeState::operational);
  // A segmented answer, a short one, one with a long identifier.
  CHECK_FALSE(canopen::answer_of(frame(0x589, {0x41, 0x08, 0x10, 0, 9, 0, 0, 0})).has_value());
  CHECK_FALSE(canopen::answer_of(frame(0x589, {0x60, 0x17, 0x10})).has_value());
  CHECK_FALSE(
      canopen::answer_of(frame(0x589 | CAN_EFF_FLAG, {0x60, 0, 0, 0, 0, 0, 0, 0})).has_value());
}

TEST_CASE("a drive goes from any state to obeying in three steps, and a fault stays one") {
  using cia402::State;
  CHECK(cia402::state_of(0x0250) == State::switch_on_disabled);
  CHECK(cia402::state_of(0x1637) == State::enabled);
  CHECK(cia402::state_of(0x0208) == State::fault);
  CHECK(cia402::state_of(0x0217) == State::quick_stop);
  CHECK(cia402::towards_enabled(State::switch_on_disabled) == 0x06);
  CHECK(cia402::towards_enabled(State::ready_to_switch_on) == 0x07);
  CHECK(cia402::towards_enabled(State::switched_on) == 0x0F);
  CHECK(cia402::towards_enabled(State::fault) == 0x00);
}

TEST_CASE(
    "a bus of 1 Mbit/s carries four drives in a millisecond, and one of 500 kbit/s carries one") {
  CHECK(canopen::max_bits(8) == 135);
  CHECK(canopen::max_bits(4) == 95);
  CHECK(canopen::max_bits(0) == 55);
  CHECK(cia402::bits_a_cycle(4) < 1000.0);
  CHECK(cia402::bits_a_cycle(5) > 1000.0);
  CHECK(cia402::bits_a_cycle(1) < 500.0);
  CHECK(cia402::bits_a_cycle(2) > 500.0);
  const auto two = file_of({{0, 1}, {0, 2}, {0, 3}, {1, 4}, {1, 5}, {1, 6}});
  REQUIRE_MESSAGE(two.has_value(), test::reason(two));
  REQUIRE(two->driven_arms.has_value());
  CHECK((*two->driven_arms)[Arm::right].joints[5].bus == "can3");
  const auto loads = bus_loads(*two->driven_arms);
  CHECK(loads.size() == 4);
  CHECK(loads[0].share == doctest::Approx(0.760).epsilon(0.001));
  const auto one = file_of({{0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}, {0, 6}});
  REQUIRE_FALSE(one.has_value());
  CHECK(one.error().fault == Fault::config);
  CHECK_MESSAGE(one.error().message.find("can0 carries 6 drives, which takes 145 % of its bits") !=
                    std::string::npos,
                one.error().message);
  CHECK_FALSE(file_of({{0, 1}, {0, 2}}, "bits_per_s = 500000\n").has_value());
}

TEST_CASE("what is wrong with drives in a device file is said") {
  const auto said = [](const std::string& text, const char* part) {
    const auto file = parse_device_file(text, "device.toml");
    REQUIRE_FALSE(file.has_value());
    CHECK_MESSAGE(file.error().message.find(part) != std::string::npos, file.error().message);
  };
  CHECK(file_of({{0, 7}, {0, 7}}).error().message.find("node 7 at can0 is named twice") !=
        std::string::npos);
  CHECK(file_of({}).error().message.find("arm.left.joint is missing") != std::string::npos);
  CHECK(file_of({{0, 1}}, "bits_per_s = 900000\n").error().message.find("is not one of 125000") !=
        std::string::npos);
  said(
      "[arm.left]\nkind = \"cia402\"\n[[arm.left.joint]]\nbus = \"can0\"\nnode = 128\n"
      "counts_per_turn = 4096\ngear = -1\ntorque = 1\n[arm.right]\nkind = \"armlink\"\n",
      "node = 128");
  said("[arm.left]\nkind = \"cia402\"\n[arm.right]\nkind = \"armlink\"\naddress = \"1.2.3.4:5\"\n",
       "is not that of the left arm; both are of one kind");
  said(
      "[arm.left]\nkind = \"cia402\"\n[[arm.left.joint]]\nbus = \"can0\"\nnode = 1\n"
      "counts_per_turn = 16777216\ngear = 100\nrated_torque_nm = 1\n",
      "make more counts a turn of the joint than 2^29");
  said("[arm.left]\nkind = \"cia402\"\n[arm.right]\nkind = \"cia402\"\n",
       "drives on CAN feel no contact: [wrist_sensor.left]");
}
