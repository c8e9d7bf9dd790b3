// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <string>
#include <vector>

#include "tests/devices/child.hpp"
#include "tuina/hardware/arm_peer.hpp"
#include "tuina/hardware/udp_socket.hpp"

namespace tuina::tests {

inline hardware::UdpAddress address_of(int port) {
  return *hardware::parse_udp_address("127.0.0.1:" + std::to_string(port));
}

/// A port that nobody listens at.
inline int free_port() {
  static int next = 40'000 + static_cast<int>(getpid() % 20'000);
  while (!hardware::UdpSocket::listen(address_of(next))) ++next;
  return next++;
}

using Program = std::vector<std::string>;
inline const Program in_c = {TUINA_ARM_CLIENT};
inline const Program in_python = {"python3", "-B", TUINA_SOURCE_DIR "/armlink/arm_client.py"};

inline Child start(Program program, int port) {
  program.push_back(std::to_string(port));
  return Child(std::move(program));
}

inline Result<hardware::ArmPeer> open_patiently(const hardware::UdpAddress& address) {
  for (int i = 0; i < 40; ++i)
    if (auto peer = hardware::ArmPeer::open(address)) return peer;
  return hardware::ArmPeer::open(address);
}

}  // namespace tuina::tests
