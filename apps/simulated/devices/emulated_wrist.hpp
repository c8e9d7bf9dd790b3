// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tuina/core/arm.hpp"
#include "tuina/hardware/udp_socket.hpp"

namespace tuina::app {

/// What becomes of a sensor in the middle of a session.
struct WristFailure {
  enum class Kind : std::uint8_t {
    none,
    silent,  ///< no sample reaches the host for 10 ms
    stuck,   ///< every sample says the same
    off,     ///< nothing is ever sent again
  };
  Kind kind = Kind::none;
  double at_s = std::numeric_limits<double>::infinity();  ///< on the clock of the simulated robot
};

/// The force sensor at the wrist of a simulated arm, at the other end of UDP: raw data transfer as
/// ATI's boxes and OptoForce's speak it. It is mounted turned and behind the tool, and its zero is
/// not zero, as a real one's; `section` says how. Safe from two threads.
class EmulatedWrist {
 public:
  /// Fails with Fault::device.
  [[nodiscard]] static Result<std::unique_ptr<EmulatedWrist>> listen(
      const hardware::UdpAddress& own, std::string address, WristFailure failure = {});

  /// Measures once, the environment's force on the tool, its weight included, and sends it.
  void feel(double time_s, const Wrench& in_tool);
  /// While the arms stand the robot's clock stands too. A sensor knows nothing of that: it says
  /// what it feels 1000 times in a second of the host's.
  void stand(bool stands);

  [[nodiscard]] const std::string& address() const noexcept { return address_; }
  /// Its section of a device file.
  [[nodiscard]] std::string section(Arm arm) const;

 private:
  EmulatedWrist(hardware::UdpSocket socket, std::string address, WristFailure failure);
  void live(const std::stop_token& stop);
  void obey_requests();
  void send(const Wrench& in_sensor, int dither_counts);

  std::mutex mutex_;
  hardware::UdpSocket socket_;
  std::string address_;
  WristFailure failure_;
  hardware::UdpAddress host_ = {};
  bool streams_ = false, stands_ = true, off_ = false;
  std::uint32_t sequence_ = 0;
  Wrench in_sensor_, stuck_;
  bool sticks_ = false;
  std::jthread thread_;
};

}  // namespace tuina::app
