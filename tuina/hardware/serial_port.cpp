// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/serial_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace tuina::hardware {
namespace {

struct LineSpeed {
  int bits_per_s;
  speed_t of;
};
constexpr std::array line_speeds = {LineSpeed{57'600, B57600}, LineSpeed{115'200, B115200},
                                    LineSpeed{500'000, B500000}, LineSpeed{1'000'000, B1000000}};

Result<void> make_raw(int number, const std::string& address, int bits_per_s) {
  const auto* speed = std::find_if(line_speeds.begin(), line_speeds.end(),
                                   [&](const LineSpeed& s) { return s.bits_per_s == bits_per_s; });
  termios line = {};
  if (speed == line_speeds.end() || ::tcgetattr(number, &line) != 0)
    return fail(Fault::device, "{} is no serial line; `tuina doctor` lists those that are",
                address);
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD | HUPCL;  // whoever ends, or is killed, leaves DTR low
  line.c_cc[VMIN] = 0;
  line.c_cc[VTIME] = 0;
  ::cfsetspeed(&line, speed->of);
  if (::tcsetattr(number, TCSANOW, &line) != 0 || ::ioctl(number, TIOCEXCL) != 0)
    return fail(Fault::device, "{} does not take {} bits per second: {}", address, bits_per_s,
                std::strerror(errno));
  return {};
}

// True once the line can be read or written, or has broken; false at the deadline.
bool wait_for(int number, short events, SerialPort::Clock::time_point deadline) {
  for (;;) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - SerialPort::Clock::now());
    pollfd wanted = {.fd = number, .events = events, .revents = 0};
    const int ready = ::poll(&wanted, 1, std::max(0, static_cast<int>(left.count())));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

}  // namespace

const std::vector<int>& serial_speeds() {
  static const std::vector<int> all = [] {
    std::vector<int> speeds;
    speeds.reserve(line_speeds.size());
    for (const LineSpeed& speed : line_speeds) speeds.push_back(speed.bits_per_s);
    return speeds;
  }();
  return all;
}

Result<SerialPort> SerialPort::open(const std::string& address, int bits_per_s) {
  SerialPort port(address, ::open(address.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (port.number_ < 0) {
    const int why = errno;
    const char* mend = why == ENOENT || why == ENODEV || why == ENXIO
                           ? "is it plugged in? `tuina doctor` lists what is"
                       : why == EACCES ? "join the group `dialout`"
                       : why == EBUSY  ? "end the program that has it"
                                       : "plug it in again";
    return fail(Fault::device, "{} cannot be opened: {}; {}", address, std::strerror(why), mend);
  }
  if (const auto raw = make_raw(port.number_, address, bits_per_s); !raw)
    return tl::unexpected(raw.error());
  return port;
}

SerialPort::~SerialPort() {
  if (number_ >= 0) ::close(number_);
}

Result<void> SerialPort::write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    const ssize_t sent = ::write(number_, bytes.data(), bytes.size());
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    if (sent < 0 && errno != EAGAIN && errno != EINTR)
      return fail(Fault::device, "{} is gone: {}; plug it in again", address_,
                  std::strerror(errno));
    if (!wait_for(number_, POLLOUT, deadline))
      return fail(Fault::device, "{} takes no bytes; plug it in again", address_);
  }
  return {};
}

Result<std::size_t> SerialPort::read(std::span<std::uint8_t> into, Clock::time_point deadline) {
  if (!wait_for(number_, POLLIN, deadline)) return std::size_t{0};
  if (const auto size = take(into)) return *size;
  return fail(Fault::device, "{} was unplugged; plug it in again", address_);
}

std::optional<std::size_t> SerialPort::take(std::span<std::uint8_t> into) noexcept {
  if (!wait_for(number_, POLLIN, Clock::now())) return std::size_t{0};
  const ssize_t size = ::read(number_, into.data(), into.size());
  if (size > 0) return static_cast<std::size_t>(size);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
  return std::nullopt;  // a line that can be read and has nothing has no other end any more
}

void SerialPort::forget() noexcept {
  std::array<std::uint8_t, 256> old;
  constexpr int max_reads = 64;  // a line that never falls silent does not hold the program
  for (int i = 0; i<max_reads&& ::read(number_, old.data(), old.size())> 0; ++i) continue;
}

Result<void> SerialPort::raise_dtr(bool high) {
  const int line = TIOCM_DTR;
  if (::ioctl(number_, high ? TIOCMBIS : TIOCMBIC, &line) == 0) return {};
  return fail(Fault::device, "{} has no line DTR to switch the laser by: {}", address_,
              std::strerror(errno));
}

}  // namespace tuina::hardware
