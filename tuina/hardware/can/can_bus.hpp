// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>

#include <optional>
#include <string>
#include <utility>

#include "tuina/core/result.hpp"

namespace tuina::hardware {

/// One CAN bus by Linux SocketCAN, with the kernel's own frames. Never blocks; takes no heap after
/// it is made.
class CanBus {
 public:
  /// Fails with Fault::device where the interface, such as "can0", is not there or not up; or where
  /// nobody emulates drives at "emulated:PROGRAM/BUS".
  [[nodiscard]] static Result<CanBus> open(const std::string& interface);
  /// On any socket that carries a `can_frame` each time, such as one end of a pair with emulated
  /// drives at the other. The socket is closed with this.
  CanBus(std::string name, int socket) : name_(std::move(name)), socket_(socket) {}
  CanBus(CanBus&& other) noexcept
      : name_(std::move(other.name_)),
        socket_(std::exchange(other.socket_, -1)),
        unsent_in_row_(other.unsent_in_row_),
        fault_(other.fault_) {}
  CanBus& operator=(CanBus&&) = delete;
  ~CanBus();

  /// Queues a frame behind those that wait; one that finds no place is lost.
  void send(const can_frame& frame) noexcept;
  /// The next frame that somebody else has sent, error frames apart; nothing when none is there.
  [[nodiscard]] std::optional<can_frame> receive() noexcept;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }  ///< of the interface
  [[nodiscard]] int socket() const noexcept { return socket_; }             ///< number, for poll
  /// Null while all is well, else what is wrong with the bus, said of "the bus can0". It stays.
  [[nodiscard]] const char* fault() const noexcept { return fault_; }

 private:
  void break_off(const char* why) noexcept {
    if (fault_ == nullptr) fault_ = why;
  }

  std::string name_;
  int socket_ = -1;
  int unsent_in_row_ = 0;
  const char* fault_ = nullptr;
};

}  // namespace tuina::hardware
