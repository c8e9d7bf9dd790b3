// SPDX-License-Identifier: Apache-2.0
// The datagrams of armlink, byte for byte, and those of the header in C beside them.
#include "tuina/hardware/armlink.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "armlink/armlink.h"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::hardware;

namespace {

JointVector joints(std::initializer_list<double> values) {
  JointVector vector(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

armlink::Command some_command() {
  return {.session = 0xA1B2C3D4,
          .sequence = 7,
          .answers = 41,
          .mode = armlink::Mode::torque,
          .brake = false,
          .rail_m = 0.125,
          .values = joints({1.5, -2.0, 0.5, 0.25, -0.75, 3.0})};
}

armlink::State some_state() {
  return {.session = 0xA1B2C3D4,
          .sequence = 42,
          .answers = 7,
          .mode = armlink::Mode::torque,
          .status = armlink::status::stopped | armlink::status::braked,
          .time_s = 12.042,
          .wrench_time_s = 12.041,
          .rail_m = 0.125,
          .q_rad = joints({0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7}),
          .dq_rad_per_s = joints({1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}),
          .tau_nm = joints({10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0}),
          .wrench_in_tool = {{1.0, -2.0, 3.0}, {0.1, 0.2, -0.3}}};
}

armlink::Hello some_hello() {
  armlink::Hello hello{.session = 3,
                       .sequence = 2,
                       .modes = bit_of(armlink::Mode::torque),
                       .flags = armlink::flag::has_rail,
                       .cycle_us = 1000,
                       .max_torque_nm = joints({100.0, 90.0, 80.0, 70.0, 60.0, 50.0}),
                       .max_speed_rad_per_s = joints({1.0, 1.5, 2.0, 2.5, 3.0, 3.5}),
                       .min_rad = joints({-3.0, -2.5, -2.0, -1.5, -1.0, -0.5}),
                       .max_rad = joints({3.0, 2.5, 2.0, 1.5, 1.0, 0.5}),
                       .min_rail_m = -0.5,
                       .max_rail_m = 0.75};
  const std::string_view name = "arm 12";
  std::copy(name.begin(), name.end(), hello.name.begin());
  return hello;
}

std::string hex_of(armlink::Bytes bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned>(byte));
  return text;
}

const std::uint8_t* plain(armlink::Bytes bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

/// Whether any decoder accepts the bytes; what it accepts it must write again just so.
bool accepted(armlink::Bytes bytes) {
  const auto same = [&](const auto& decoded) {
    if (!decoded) return false;
    CHECK(hex_of(armlink::encode(*decoded)) == hex_of(bytes));
    return true;
  };
  return same(armlink::decode_ask(bytes)) || same(armlink::decode_hello(bytes)) ||
         same(armlink::decode_command(bytes)) || same(armlink::decode_state(bytes));
}

}  // namespace

TEST_CASE("the example of the specification is the command that it says, byte for byte") {
  const std::string page = [] {
    std::ostringstream text;
    text << std::ifstream(TUINA_SOURCE_DIR "/docs/armlink.md").rdbuf();
    return text.str();
  }();
  const std::size_t begin = page.find("```hex\n"), end = page.find("```", begin + 7);
  REQUIRE(begin != std::string::npos);
  std::string printed;
  for (const char letter : page.substr(begin + 7, end - begin - 7))
    if (std::isxdigit(static_cast<unsigned char>(letter)) != 0) printed += letter;
  CHECK(printed == hex_of(armlink::encode(some_command())));
}

TEST_CASE("every kind of datagram comes out as it went in") {
  CHECK(accepted(armlink::encode(armlink::Ask{.session = 9, .sequence = 1})));
  CHECK(accepted(armlink::encode(some_hello())));
  CHECK(accepted(armlink::encode(some_command())));
  CHECK(accepted(armlink::encode(some_state())));
  const auto state = armlink::decode_state(armlink::encode(some_state()));
  REQUIRE(state.has_value());
  CHECK(state->q_rad == some_state().q_rad);
  CHECK(state->wrench_in_tool.torque_nm == some_state().wrench_in_tool.torque_nm);
  CHECK(state->wrench_time_s == 12.041);
  CHECK(some_hello().called() == "arm 12");
}

TEST_CASE("no bit may fall over, and no byte may be missing or too many") {
  const auto good = armlink::encode(some_state());
  std::vector<std::byte> bytes(good.begin(), good.end());
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    refused += armlink::decode_state(bytes) ? 0 : 1;
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
  }
  CHECK(refused == 8 * static_cast<int>(armlink::state_size));
  CHECK(armlink::decode_state(armlink::Bytes(bytes).first(267)).error() == armlink::Spoilt::size);
  CHECK(armlink::decode_state(armlink::Bytes(bytes).first(19)).error() == armlink::Spoilt::foreign);
  bytes.push_back(std::byte{0});
  CHECK(armlink::decode_state(bytes).error() == armlink::Spoilt::size);
  CHECK(armlink::decode_state(armlink::encode(some_command())).error() == armlink::Spoilt::kind);
  bytes[4] = std::byte{2};
  CHECK(armlink::decode_state(bytes).error() == armlink::Spoilt::version);
}

TEST_CASE("values that cannot be are refused though the check sum is right") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  armlink::State state = some_state();
  state.q_rad[3] = nan;
  CHECK(armlink::decode_state(armlink::encode(state)).error() == armlink::Spoilt::value);
  state = some_state();
  state.wrench_in_tool.force_n.y() = std::numeric_limits<double>::infinity();
  CHECK(armlink::decode_state(armlink::encode(state)).error() == armlink::Spoilt::value);
  state = some_state();
  state.q_rad.resize(0);
  CHECK(armlink::decode_state(armlink::encode(state)).error() == armlink::Spoilt::value);
  armlink::Command command = some_command();
  command.mode = armlink::Mode::admittance;  // reserved
  CHECK(armlink::decode_command(armlink::encode(command)).error() == armlink::Spoilt::value);
  armlink::Hello hello = some_hello();
  hello.name.fill('x');  // does not end
  CHECK(armlink::decode_hello(armlink::encode(hello)).error() == armlink::Spoilt::value);
}

TEST_CASE("the header in C writes what is read here") {
  armlink_state state = {};
  const armlink::State wanted = some_state();
  state.session = wanted.session, state.sequence = wanted.sequence, state.answers = wanted.answers;
  state.mode = ARMLINK_TORQUE, state.joints = 7, state.status = wanted.status;
  state.time_s = wanted.time_s, state.wrench_time_s = wanted.wrench_time_s;
  state.rail_m = wanted.rail_m;
  std::copy(wanted.q_rad.begin(), wanted.q_rad.end(), state.q_rad);
  std::copy(wanted.dq_rad_per_s.begin(), wanted.dq_rad_per_s.end(), state.dq_rad_per_s);
  std::copy(wanted.tau_nm.begin(), wanted.tau_nm.end(), state.tau_nm);
  for (int i = 0; i < 3; ++i) {
    state.wrench_in_tool[i] = wanted.wrench_in_tool.force_n[i];
    state.wrench_in_tool[i + 3] = wanted.wrench_in_tool.torque_nm[i];
  }
  std::array<std::byte, ARMLINK_STATE_SIZE> in_c;
  armlink_write_state(reinterpret_cast<std::uint8_t*>(in_c.data()), &state);
  CHECK(hex_of(in_c) == hex_of(armlink::encode(wanted)));

  armlink_hello hello = {};
  const armlink::Hello told = some_hello();
  hello.session = told.session, hello.sequence = told.sequence, hello.joints = 6;
  hello.modes = told.modes, hello.flags = told.flags, hello.cycle_us = told.cycle_us;
  std::copy(told.name.begin(), told.name.end(), hello.name);
  std::copy(told.max_torque_nm.begin(), told.max_torque_nm.end(), hello.max_torque_nm);
  std::copy(told.max_speed_rad_per_s.begin(), told.max_speed_rad_per_s.end(),
            hello.max_speed_rad_per_s);
  std::copy(told.min_rad.begin(), told.min_rad.end(), hello.min_rad);
  std::copy(told.max_rad.begin(), told.max_rad.end(), hello.max_rad);
  hello.min_rail_m = told.min_rail_m, hello.max_rail_m = told.max_rail_m;
  std::array<std::byte, ARMLINK_HELLO_SIZE> hello_in_c;
  armlink_write_hello(reinterpret_cast<std::uint8_t*>(hello_in_c.data()), &hello);
  CHECK(hex_of(hello_in_c) == hex_of(armlink::encode(told)));
}

TEST_CASE("the header in C reads what is written here, and refuses what is refused here") {
  const auto bytes = armlink::encode(some_command());
  REQUIRE(armlink_kind(plain(bytes), static_cast<int>(bytes.size())) == ARMLINK_COMMAND);
  armlink_command command;
  REQUIRE(armlink_read_command(plain(bytes), &command) == 1);
  CHECK(command.session == 0xA1B2C3D4);
  CHECK(command.sequence == 7);
  CHECK(command.answers == 41);
  CHECK(command.mode == ARMLINK_TORQUE);
  CHECK(command.joints == 6);
  CHECK(command.brake == 0);
  CHECK(command.rail_m == 0.125);
  CHECK(command.values[5] == 3.0);
  // A byte becomes another, its check sum right or wrong: both sides agree on it.
  Random random = make_random(5, "armlink");
  int sound = 0;
  for (int i = 0; i < 20'000; ++i) {
    auto spoilt = bytes;
    const auto at = static_cast<std::size_t>(uniform(random, 0.0, 91.999));
    spoilt[at] = static_cast<std::byte>(uniform(random, 0.0, 255.999));
    const bool mended = i % 2 == 0;
    if (mended) {
      auto* out = reinterpret_cast<std::uint8_t*>(spoilt.data());
      armlink_end(out, ARMLINK_COMMAND_SIZE);
    }
    const bool here = armlink::decode_command(spoilt).has_value();
    const bool in_c = armlink_kind(plain(spoilt), ARMLINK_COMMAND_SIZE) == ARMLINK_COMMAND &&
                      armlink_read_command(plain(spoilt), &command) == 1;
    if (here != in_c) FAIL("byte ", at, " of ", hex_of(spoilt));
    sound += here ? 1 : 0;
  }
  CHECK(sound > 5'000);
  CHECK(sound < 19'000);
}
