// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tuina/hardware/board_clock.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/dynamixel.hpp"

namespace tuina::hardware {

/// Addresses in the control table of an AX-12A [ax12].
namespace ax12 {
inline constexpr std::uint8_t model = 0, return_delay = 5, angle_limits = 6, goal = 30,
                              position = 36;
}  // namespace ax12

/// The board of `firmware/scanner` is a device of the same protocol: it passes on what is not for
/// it, and has one instruction of its own, which asks the motor, stamps its answer and keeps the
/// laser lit.
namespace scanner_board {
inline constexpr std::uint8_t id = 200, poll = 0x10, version = 2;
inline constexpr std::size_t asked_bytes = 3, told_bytes = 18;
/// Why the board put the laser out.
enum class Drop : std::uint8_t { none, silence, stands, too_long, no_motor };
}  // namespace scanner_board

/// An AX-12A and the laser's switch, over one serial line. Every failure is Fault::device and names
/// the line.
class YawServo {
 public:
  /// Fails when nobody answers there, or another device than an AX-12A in joint mode.
  [[nodiscard]] static Result<YawServo> open(const TurntableDevice& device);

  /// Where the motor was, and when: as the last byte of its question reached it.
  struct Told {
    double stamp_s = 0.0;  ///< on the clock of `host_s`
    int count = 0;         ///< 0 to 1023, over 300 degrees
    bool moving = false;
  };
  /// Asks where the motor is. The laser is lit, or kept so, or goes out. Fails also when the motor
  /// tells an error, or the board has put the laser out by itself.
  [[nodiscard]] Result<Told> poll(bool lit);
  /// `count` 0 to 1023; `speed` in units of 0.111 rpm, 1 to 1023.
  [[nodiscard]] Result<void> turn_to(int count, int speed);
  /// A stamp on the host's steady clock.
  [[nodiscard]] double host_s(double stamp_s) const;

  /// Who answered, such as "board version 2, AX-12A (model 12), round trip 1.9 ms".
  [[nodiscard]] std::string who() const;
  /// The turntable as its file describes it.
  [[nodiscard]] const TurntableDevice& device() const { return device_; }

 private:
  YawServo(TurntableDevice device, DynamixelBus bus)
      : device_(std::move(device)), bus_(std::move(bus)) {}
  [[nodiscard]] Result<void> greet();
  [[nodiscard]] Result<void> greet_motor();
  [[nodiscard]] Result<Told> poll_board(bool lit);
  [[nodiscard]] Result<Told> poll_motor(bool lit);
  [[nodiscard]] Result<std::vector<std::uint8_t>> ask(std::uint8_t what,
                                                      const std::vector<std::uint8_t>& parameters,
                                                      std::size_t bytes);
  [[nodiscard]] Result<std::vector<std::uint8_t>> read(std::uint8_t address, std::uint8_t bytes);
  [[nodiscard]] Result<void> write(std::uint8_t address, std::vector<std::uint8_t> bytes);
  [[nodiscard]] double line_s(std::size_t parameters) const;
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const;

  TurntableDevice device_;
  DynamixelBus bus_;
  BoardClock clock_;
  double min_round_trip_s_ = 1e9;
  double return_delay_s_ = 0.0;  ///< of the motor, before it answers
  int model_ = 0;
  std::uint8_t sequence_ = 0;
  bool lit_ = false;
};

}  // namespace tuina::hardware
