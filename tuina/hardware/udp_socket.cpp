// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/udp_socket.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

namespace tuina::hardware {
namespace {

const sockaddr* plain(const UdpAddress& address) noexcept {
  return reinterpret_cast<const sockaddr*>(&address.of);
}

std::string text_of(const UdpAddress& address) {
  std::array<char, INET_ADDRSTRLEN> host = {};
  inet_ntop(AF_INET, &address.of.sin_addr, host.data(), host.size());
  return fmt::format("{}:{}", host.data(), ntohs(address.of.sin_port));
}

int open_socket() noexcept {
  return ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

}  // namespace

std::optional<UdpAddress> parse_udp_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  UdpAddress address;
  address.of.sin_family = AF_INET;
  const std::string host(text.substr(0, colon));
  if (inet_pton(AF_INET, host.c_str(), &address.of.sin_addr) != 1) return std::nullopt;
  const std::string_view port_text = text.substr(colon + 1);
  std::uint16_t port = 0;
  const auto [end, fault] =
      std::from_chars(port_text.data(), port_text.data() + port_text.size(), port);
  if (fault != std::errc() || end != port_text.data() + port_text.size() || port == 0)
    return std::nullopt;
  address.of.sin_port = htons(port);
  return address;
}

Result<UdpSocket> UdpSocket::connect(const UdpAddress& peer) {
  UdpSocket made(open_socket());
  if (made.number_ < 0 || ::connect(made.number_, plain(peer), sizeof peer.of) != 0)
    return fail(Fault::device,
                "{}: cannot be reached: {}; is the address right, and its network up?",
                text_of(peer), std::strerror(errno));
  return made;
}

Result<UdpSocket> UdpSocket::listen(const UdpAddress& own) {
  UdpSocket made(open_socket());
  if (made.number_ < 0 || ::bind(made.number_, plain(own), sizeof own.of) != 0)
    return fail(Fault::device, "{}: cannot be listened at: {}", text_of(own), std::strerror(errno));
  return made;
}

UdpSocket::~UdpSocket() {
  if (number_ >= 0) ::close(number_);
}

void UdpSocket::send(std::span<const std::byte> datagram) noexcept {
  (void)::send(number_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

void UdpSocket::send(std::span<const std::byte> datagram, const UdpAddress& to) noexcept {
  (void)::sendto(number_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL, plain(to),
                 sizeof to.of);
}

std::optional<std::size_t> UdpSocket::receive(std::span<std::byte> into,
                                              UdpAddress* from) noexcept {
  UdpAddress sender;
  socklen_t length = sizeof sender.of;
  // A peer that has gone answers with an error in place of a datagram, which is then used up.
  for (int tries = 0; tries < 2; ++tries) {
    const ssize_t size = ::recvfrom(number_, into.data(), into.size(), MSG_DONTWAIT,
                                    reinterpret_cast<sockaddr*>(&sender.of), &length);
    if (size < 0 && errno == ECONNREFUSED) continue;
    if (size < 0) return std::nullopt;
    if (from != nullptr) *from = sender;
    return static_cast<std::size_t>(size);
  }
  return std::nullopt;
}

void wait_for_datagram(std::span<const int> sockets,
                       std::chrono::steady_clock::time_point deadline) noexcept {
  constexpr std::size_t max_sockets = 4;
  std::array<pollfd, max_sockets> wanted = {};
  const std::size_t count = std::min(sockets.size(), max_sockets);
  for (std::size_t i = 0; i < count; ++i) wanted[i] = {.fd = sockets[i], .events = POLLIN};
  const auto left = std::max(deadline - std::chrono::steady_clock::now(),
                             std::chrono::steady_clock::duration::zero());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  const timespec patience = {
      .tv_sec = seconds.count(),
      .tv_nsec = std::chrono::duration_cast<std::chrono::nanoseconds>(left - seconds).count()};
  (void)::ppoll(wanted.data(), count, &patience, nullptr);
}

}  // namespace tuina::hardware
