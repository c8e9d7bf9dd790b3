// SPDX-License-Identifier: Apache-2.0
#include "tests/history/relay.hpp"

#include <doctest/doctest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <random>

namespace tuina::test {
namespace {

constexpr const char* socket_name = "/.s.PGSQL.5432";
/// A connection begins with some 500 bytes, and a session takes some 3000.
constexpr int max_bytes = 8000;

int stream_socket() {
  return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
}

sockaddr_un place(const std::string& folder) {
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  const std::string path = folder + socket_name;
  REQUIRE(path.size() < sizeof at.sun_path);
  std::memcpy(at.sun_path, path.c_str(), path.size());
  return at;
}

/// Carries what there is, at most `left` bytes; false when a side has ended or all is used up.
bool pass(int from, int to, long& left) {
  std::array<char, 1024> bytes{};
  const auto wanted = std::min<long>(left, static_cast<long>(bytes.size()));
  const ssize_t got = ::recv(from, bytes.data(), static_cast<std::size_t>(wanted), 0);
  if (got <= 0) return false;
  left -= got;
  return ::send(to, bytes.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL) == got && left > 0;
}

}  // namespace

Relay::Relay(const std::string& address, std::uint64_t seed)
    : random_(make_random(seed, "cuts")), listening_(stream_socket()) {
  const std::size_t begin = address.find("host=") + 5, end = address.find('&', begin);
  server_ = address.substr(begin, end - begin);
  address_ = address.substr(0, begin) + folder_.path().string() + address.substr(end);
  const sockaddr_un at = place(folder_.path());
  REQUIRE(::bind(listening_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
  REQUIRE(::listen(listening_, 8) == 0);
  thread_ = std::thread([this] { listen(); });
}

Relay::~Relay() {
  ends_ = true;
  thread_.join();
  ::close(listening_);
}

void Relay::listen() {
  while (!ends_) {
    pollfd coming{.fd = listening_, .events = POLLIN, .revents = 0};
    if (::poll(&coming, 1, 20) <= 0) continue;
    const int program = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
    if (program < 0) continue;
    carry(program);
    ::close(program);
  }
}

void Relay::carry(int program) {
  const int server = stream_socket();
  const sockaddr_un at = place(server_);
  if (::connect(server, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0) {
    const bool cutting = cutting_;
    long left = cutting ? std::uniform_int_distribution<int>(1, max_bytes)(random_)
                        : std::numeric_limits<long>::max();
    bool open = true;
    while (open && !ends_) {
      std::array<pollfd, 2> sides = {{{.fd = program, .events = POLLIN, .revents = 0},
                                      {.fd = server, .events = POLLIN, .revents = 0}}};
      if (::poll(sides.data(), sides.size(), 20) <= 0) continue;
      if (sides[0].revents != 0) open = pass(program, server, left);
      if (open && sides[1].revents != 0) open = pass(server, program, left);
    }
    if (cutting && left <= 0) ++cuts_;
  }
  ::close(server);
}

}  // namespace tuina::test
