// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <string>

#include "tests/devices/mega.hpp"
#include "tests/hardware/pseudo_terminal.hpp"
#include "tests/hardware/servo_emulator.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::tests {

/// The scanner's board as a host finds it at a serial line: its firmware in simavr behind a pty,
/// and an AX-12A at its other line. Its time goes by `run_to` alone.
class FirmwareBoard {
 public:
  explicit FirmwareBoard(const std::string& elf) : mega_(elf) {
    servo_.ripple_counts = ripple_rad / scanner::yaw_count_rad;
    servo_.ripple_period_counts = ripple_period_rad / scanner::yaw_count_rad;
    mega_.on_byte = [this](int line, std::uint8_t byte) {
      if (line == 0 && line_.end() >= 0) (void)!::write(line_.end(), &byte, 1);
      if (line == 1) hear_motor_line(byte);
    };
  }
  bool motor_silent = false;  ///< the motor answers no more

  void run_to(double time_s) {
    std::uint8_t bytes[64];
    const ssize_t size = line_.end() >= 0 ? ::read(line_.end(), bytes, sizeof bytes) : 0;
    for (ssize_t i = 0; i < size; ++i) mega_.send(0, bytes[i], mega_.time_s());
    mega_.run_to(time_s);
  }
  void unplug() { line_.unplug(); }
  [[nodiscard]] const std::string& address() const { return line_.address(); }
  [[nodiscard]] bool lit() const { return mega_.laser_lit(); }
  [[nodiscard]] bool crashed() const { return mega_.crashed(); }
  [[nodiscard]] double time_s() const { return mega_.time_s(); }
  [[nodiscard]] ServoEmulator& servo() { return servo_; }

 private:
  // The gear of the simulated scanner turns as unevenly.
  static constexpr double ripple_rad = from_deg(0.02), ripple_period_rad = from_deg(7.0);
  static constexpr double byte_of_motor_s = 10e-6;

  // One wire: what the board sends comes back to it, and reaches the motor.
  void hear_motor_line(std::uint8_t byte) {
    mega_.send(1, byte, mega_.time_s());
    motor_line_.add({&byte, 1});
    while (const auto packet = motor_line_.next()) {
      if (motor_silent) continue;
      double due_s = mega_.time_s() + ServoEmulator::answer_after_s;
      for (const std::uint8_t one : servo_.answer(*packet, mega_.time_s()))
        mega_.send(1, one, due_s += byte_of_motor_s);
    }
  }

  Mega mega_;
  ServoEmulator servo_;
  hardware::dynamixel::Reader motor_line_;
  PseudoTerminal line_;
};

}  // namespace tuina::tests
