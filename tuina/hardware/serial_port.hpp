// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::hardware {

/// Speeds of a serial line that the driver knows, in bits per second.
[[nodiscard]] const std::vector<int>& serial_speeds();

/// A serial line: raw bytes, 8N1, no flow control, for this process alone. Every failure is
/// Fault::device and names the line.
class SerialPort {
 public:
  /// The clock of deadlines.
  using Clock = std::chrono::steady_clock;

  /// `bits_per_s`: one of `serial_speeds`.
  [[nodiscard]] static Result<SerialPort> open(const std::string& address, int bits_per_s);
  SerialPort(SerialPort&& other) noexcept
      : address_(std::move(other.address_)), number_(std::exchange(other.number_, -1)) {}
  SerialPort& operator=(SerialPort&& other) noexcept {
    std::swap(address_, other.address_);
    std::swap(number_, other.number_);
    return *this;
  }
  ~SerialPort();

  /// Fails when not all bytes could be sent by the deadline.
  [[nodiscard]] Result<void> write(std::span<const std::uint8_t> bytes, Clock::time_point deadline);
  /// Waits for at least one byte; 0 when none came by the deadline. Fails when the line is gone.
  [[nodiscard]] Result<std::size_t> read(std::span<std::uint8_t> into, Clock::time_point deadline);
  /// What has come already, without heap: 0 when nothing has, nothing when the line is gone.
  [[nodiscard]] std::optional<std::size_t> take(std::span<std::uint8_t> into) noexcept;
  /// Forgets what has come and was not read.
  void forget() noexcept;
  /// Raises or lowers the line DTR, which the kernel lowers when this process ends.
  [[nodiscard]] Result<void> raise_dtr(bool high);
  [[nodiscard]] const std::string& address() const { return address_; }  ///< name of the line
  /// Number of the open file, for poll.
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  SerialPort(std::string address, int number) : address_(std::move(address)), number_(number) {}
  std::string address_;
  int number_ = -1;
};

}  // namespace tuina::hardware
