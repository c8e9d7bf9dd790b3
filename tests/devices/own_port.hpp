// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>

namespace tuina::test {

/// Whether nobody listens at a UDP port of this machine.
inline bool is_free(int port) {
  const int number = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool free =
      ::bind(number, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(number);
  return free;
}

/// The first of eight UDP ports that no other run of a test has.
inline int own_port() {
  constexpr int ports = 8;
  static int next = 21'000 + ports * static_cast<int>(getpid() % 1'200);
  for (;;) {
    next += ports;
    bool free = true;
    for (int i = 0; i < ports; ++i) free = free && is_free(next + i);
    if (free) return next;
  }
}

}  // namespace tuina::test
