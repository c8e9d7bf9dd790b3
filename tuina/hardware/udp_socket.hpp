// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "tuina/core/result.hpp"

namespace tuina::hardware {

/// Where a device listens: an IPv4 address and a port from 1 to 65535, "192.168.3.10:7001".
struct UdpAddress {
  sockaddr_in of = {};
  [[nodiscard]] bool operator==(const UdpAddress& other) const noexcept {
    return of.sin_addr.s_addr == other.of.sin_addr.s_addr && of.sin_port == other.of.sin_port;
  }
};
/// Nothing where the text is no such address.
[[nodiscard]] std::optional<UdpAddress> parse_udp_address(std::string_view text);

/// A datagram socket that never blocks. `send` and `receive` take no heap.
class UdpSocket {
 public:
  /// Hears `peer` only and sends to it. Fails with Fault::device.
  [[nodiscard]] static Result<UdpSocket> connect(const UdpAddress& peer);
  /// Hears anybody at this address. Fails with Fault::device, where it is taken for one.
  [[nodiscard]] static Result<UdpSocket> listen(const UdpAddress& own);
  UdpSocket(UdpSocket&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  UdpSocket& operator=(UdpSocket&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~UdpSocket();

  /// To the peer. UDP promises nothing; neither does this.
  void send(std::span<const std::byte> datagram) noexcept;
  /// To another address.
  void send(std::span<const std::byte> datagram, const UdpAddress& to) noexcept;
  /// The size of the next datagram, as much of it as fits in `into`; nothing when none is there.
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::byte> into,
                                                   UdpAddress* from = nullptr) noexcept;
  [[nodiscard]] int number() const noexcept { return number_; }  ///< number of the socket, for poll

 private:
  explicit UdpSocket(int number) : number_(number) {}
  int number_ = -1;
};

/// Waits until one of the sockets has a datagram, or until the deadline.
void wait_for_datagram(std::span<const int> sockets,
                       std::chrono::steady_clock::time_point deadline) noexcept;

}  // namespace tuina::hardware
