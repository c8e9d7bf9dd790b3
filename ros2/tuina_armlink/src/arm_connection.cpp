// SPDX-License-Identifier: Apache-2.0
#include "arm_connection.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <random>

namespace tuina_armlink {

ArmConnection::~ArmConnection() {
  if (socket_ >= 0) close(socket_);
}

bool ArmConnection::open(const std::string& address, int port) {
  sockaddr_in arm = {};
  arm.sin_family = AF_INET;
  arm.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, address.c_str(), &arm.sin_addr) != 1) return false;
  if (socket_ >= 0) close(socket_);
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  session_ = std::random_device()() | 1U;  // not 0
  sequence_ = heard_ = 0;
  any_heard_ = false;
  return socket_ >= 0 && connect(socket_, reinterpret_cast<sockaddr*>(&arm), sizeof arm) == 0;
}

std::optional<armlink_hello> ArmConnection::ask() {
  std::vector<std::uint8_t> bytes(ARMLINK_ASK_SIZE);
  armlink_begin(bytes.data(), ARMLINK_ASK, ARMLINK_ASK_SIZE, session_, ++sequence_);
  armlink_end(bytes.data(), ARMLINK_ASK_SIZE);
  (void)send(socket_, bytes.data(), bytes.size(), 0);
  pollfd answer = {socket_, POLLIN, 0};
  constexpr int patience_ms = 500;
  if (poll(&answer, 1, patience_ms) != 1 || !receive(ARMLINK_HELLO, bytes)) return std::nullopt;
  armlink_hello hello = {};
  hello.joints = bytes[ARMLINK_HELLO_AT_JOINTS];
  hello.modes = bytes[ARMLINK_HELLO_AT_MODES];
  hello.flags = static_cast<std::uint16_t>(armlink_get(&bytes[ARMLINK_HELLO_AT_FLAGS], 2));
  hello.cycle_us = static_cast<std::uint32_t>(armlink_get(&bytes[ARMLINK_HELLO_AT_CYCLE_US], 4));
  armlink_get_doubles(&bytes[ARMLINK_HELLO_AT_MAX_TORQUE], hello.max_torque_nm, ARMLINK_MAX_JOINTS);
  return hello;
}

std::optional<armlink_state> ArmConnection::newest_state() {
  std::optional<armlink_state> newest;
  std::vector<std::uint8_t> bytes;
  while (receive(ARMLINK_STATE, bytes)) {
    armlink_state& state = newest.emplace();
    any_heard_ = true;
    state.sequence = heard_ =
        static_cast<std::uint32_t>(armlink_get(&bytes[ARMLINK_AT_SEQUENCE], 4));
    state.mode = bytes[ARMLINK_STATE_AT_MODE];
    state.joints = bytes[ARMLINK_STATE_AT_JOINTS];
    state.status = static_cast<std::uint16_t>(armlink_get(&bytes[ARMLINK_STATE_AT_STATUS], 2));
    armlink_get_doubles(&bytes[ARMLINK_STATE_AT_TIME], &state.time_s, 1);
    armlink_get_doubles(&bytes[ARMLINK_STATE_AT_Q], state.q_rad, ARMLINK_MAX_JOINTS);
    armlink_get_doubles(&bytes[ARMLINK_STATE_AT_DQ], state.dq_rad_per_s, ARMLINK_MAX_JOINTS);
    armlink_get_doubles(&bytes[ARMLINK_STATE_AT_TAU], state.tau_nm, ARMLINK_MAX_JOINTS);
    armlink_get_doubles(&bytes[ARMLINK_STATE_AT_WRENCH], state.wrench_in_tool, 6);
  }
  return newest;
}

void ArmConnection::command(armlink_mode mode, const std::vector<double>& values, double rail_m) {
  std::uint8_t bytes[ARMLINK_COMMAND_SIZE];
  armlink_begin(bytes, ARMLINK_COMMAND, ARMLINK_COMMAND_SIZE, session_, ++sequence_);
  armlink_put(bytes + ARMLINK_COMMAND_AT_ANSWERS, heard_, 4);
  armlink_put(bytes + ARMLINK_COMMAND_AT_MODE, static_cast<std::uint64_t>(mode), 1);
  armlink_put(bytes + ARMLINK_COMMAND_AT_JOINTS, values.size(), 1);
  armlink_put_doubles(bytes + ARMLINK_COMMAND_AT_RAIL, &rail_m, 1);
  armlink_put_doubles(bytes + ARMLINK_COMMAND_AT_VALUES, values.data(),
                      static_cast<int>(values.size()));
  armlink_end(bytes, ARMLINK_COMMAND_SIZE);
  (void)send(socket_, bytes, sizeof bytes, 0);
}

bool ArmConnection::receive(int kind, std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t longer_than_any = 1024;
  for (;;) {
    bytes.resize(longer_than_any);
    const ssize_t size = recv(socket_, bytes.data(), bytes.size(), 0);
    if (size < 0) return false;
    bytes.resize(static_cast<std::size_t>(size));
    if (armlink_kind(bytes.data(), static_cast<int>(size)) != kind) continue;
    if (armlink_get(&bytes[ARMLINK_AT_SESSION], 4) != session_) continue;
    const auto sequence = static_cast<std::uint32_t>(armlink_get(&bytes[ARMLINK_AT_SEQUENCE], 4));
    // The count goes on from zero after 50 days.
    const bool newer = !any_heard_ || static_cast<std::int32_t>(sequence - heard_) > 0;
    if (kind == ARMLINK_STATE && !newer) continue;
    return true;
  }
}

}  // namespace tuina_armlink
