// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/emulated_bus.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace tuina::hardware {
namespace {

constexpr std::string_view scheme = "emulated:";

/// Beside the files of the machine: it goes with the program that has it.
struct Address {
  sockaddr_un of = {};
  socklen_t size = 0;
  explicit Address(std::string_view bus) {
    of.sun_family = AF_UNIX;
    const std::string name = "tuina-" + std::string(bus.substr(scheme.size()));
    const std::size_t used = name.copy(of.sun_path + 1, sizeof of.sun_path - 1);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + used);
  }
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&of); }
};

int frames_socket() {
  return ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

tl::unexpected<Error> closed(int socket, const std::string& bus, const char* what) {
  const int cause = errno;
  if (socket >= 0) ::close(socket);
  return fail(Fault::device, "{}: {}: {}", bus, what, std::strerror(cause));
}

}  // namespace

std::optional<std::string> emulator_of(std::string_view bus) {
  if (!bus.starts_with(scheme)) return std::nullopt;
  bus.remove_prefix(scheme.size());
  return std::string(bus.substr(0, bus.find('/')));
}

Result<int> connect_to_emulated(const std::string& bus) {
  const Address address(bus);
  const int socket = frames_socket();
  if (socket < 0 || ::connect(socket, address.get(), address.size) != 0)
    return closed(socket, bus, "nobody emulates drives there, as `tuina robot can` does");
  return socket;
}

Result<int> listen_as_emulated(const std::string& bus) {
  constexpr int max_waiting = 4;
  const Address address(bus);
  const int socket = frames_socket();
  if (socket < 0 || ::bind(socket, address.get(), address.size) != 0 ||
      ::listen(socket, max_waiting) != 0)
    return closed(socket, bus, "cannot be emulated");
  return socket;
}

}  // namespace tuina::hardware
