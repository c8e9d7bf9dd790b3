// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/can_bus.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "tuina/hardware/can/emulated_bus.hpp"

namespace tuina::hardware {
namespace {

constexpr int max_unsent = 20;  // frames in a row; two cycles of a full bus

bool is_up(int socket, const std::string& interface) noexcept {
  ifreq asked = {};
  interface.copy(asked.ifr_name, sizeof asked.ifr_name - 1);
  return ::ioctl(socket, SIOCGIFFLAGS, &asked) == 0 && (asked.ifr_flags & IFF_UP) != 0;
}

}  // namespace

Result<CanBus> CanBus::open(const std::string& interface) {
  if (emulator_of(interface)) {
    const auto socket = connect_to_emulated(interface);
    if (!socket) return tl::unexpected(socket.error());
    return CanBus(interface, *socket);
  }
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0)
    return fail(Fault::device,
                "{}: there is no such CAN interface; `ip -brief link` lists those that are there",
                interface);
  CanBus bus(interface, ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (bus.socket_ < 0)
    return fail(Fault::device,
                "{}: this kernel gives no CAN socket: {}; try `sudo modprobe can_raw`", interface,
                std::strerror(errno));
  if (!is_up(bus.socket_, interface))
    return fail(Fault::device,
                "{}: is down; `sudo ip link set {} up txqueuelen 100 type can bitrate 1000000`",
                interface, interface);
  const can_err_mask_t told = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  sockaddr_can address = {};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (::setsockopt(bus.socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &told, sizeof told) != 0 ||
      ::bind(bus.socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return fail(Fault::device, "{}: {}", interface, std::strerror(errno));
  return bus;
}

CanBus::~CanBus() {
  if (socket_ >= 0) ::close(socket_);
}

void CanBus::send(const can_frame& frame) noexcept {
  if (::send(socket_, &frame, sizeof frame, MSG_DONTWAIT | MSG_NOSIGNAL) == sizeof frame) {
    unsent_in_row_ = 0;
    return;
  }
  if (errno == EPIPE || errno == ENODEV || errno == ENXIO) return break_off("was unplugged");
  if (errno == ENETDOWN) return break_off("went down");
  // Frames that nobody acknowledges are sent again and again, and those behind them wait.
  if (++unsent_in_row_ >= max_unsent) break_off("takes no more frames: nobody acknowledges them");
}

std::optional<can_frame> CanBus::receive() noexcept {
  can_frame frame = {};
  constexpr int max_error_frames = 100;
  for (int i = 0; i < max_error_frames; ++i) {
    const ssize_t size = ::recv(socket_, &frame, sizeof frame, MSG_DONTWAIT);
    if (size == 0) break_off("was unplugged");
    if (size < 0 && errno != EAGAIN && errno != EINTR)
      break_off(errno == ENETDOWN ? "went down" : "was unplugged");
    if (size != sizeof frame) return std::nullopt;
    if ((frame.can_id & CAN_ERR_FLAG) == 0) return frame;
    if ((frame.can_id & CAN_ERR_BUSOFF) != 0)
      break_off("is off after too many errors: look at its wires, terminators and bit rate");
    if ((frame.can_id & CAN_ERR_RESTARTED) != 0) break_off("was off and began anew");
  }
  return std::nullopt;
}

}  // namespace tuina::hardware
