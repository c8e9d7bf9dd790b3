// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "tuina/hardware/can/canopen.hpp"

// A drive as [cia402] has it: its states, its modes, and what it and its host say in each cycle.
namespace tuina::hardware::cia402 {

/// Where a drive stands between power and motion.
enum class State : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  enabled,  ///< obeys; its brake is open
  quick_stop,
  fault_reaction,
  fault,
};
[[nodiscard]] State state_of(std::uint16_t status) noexcept;
[[nodiscard]] const char* name_of(State state) noexcept;
/// Whether an enabled drive does what it is ordered, in the cyclic modes.
[[nodiscard]] constexpr bool follows(std::uint16_t status) noexcept {
  return (status & 0x1000U) != 0;
}

/// Control words.
namespace control {
inline constexpr std::uint16_t disable = 0x00, quick_stop = 0x02, shutdown = 0x06, switch_on = 0x07,
                               enable = 0x0F, reset = 0x80;
}
/// The word that brings a drive one state nearer to obeying. A fault stays one.
[[nodiscard]] std::uint16_t towards_enabled(State state) noexcept;

/// Both cyclic synchronous: a position or a torque in each cycle.
enum class Mode : std::uint8_t { position = 8, torque = 10 };

/// What a drive tells upon a SYNC: 0x6041, 0x6064, 0x6077.
struct Told {
  std::uint16_t status = 0;
  std::int32_t counts = 0;    ///< of the motor's encoder
  std::int16_t permille = 0;  ///< of the motor's rated torque
};
/// Nothing where the frame has another size.
[[nodiscard]] std::optional<Told> told_of(const can_frame& frame) noexcept;
[[nodiscard]] can_frame encode(std::uint8_t node, const Told& told) noexcept;

/// What a drive is ordered for the next SYNC: 0x6040, 0x6071.
struct Ordered {
  std::uint16_t control = 0;
  std::int16_t permille = 0;
};
[[nodiscard]] can_frame encode(std::uint8_t node, const Ordered& ordered) noexcept;
/// Where it should be, 0x607A, while it holds a position.
[[nodiscard]] can_frame placed(std::uint8_t node, std::int32_t counts) noexcept;

/// Entries of a drive's dictionary.
namespace object {
using canopen::Object;
inline constexpr Object device_type{0x1000}, vendor{0x1018, 1}, product{0x1018, 2},
    serial{0x1018, 4}, host_heartbeat{0x1016, 1}, own_heartbeat{0x1017, 0, 2},
    host_lost{0x6007, 0, 2}, error_code{0x603F, 0, 2}, control_word{0x6040, 0, 2},
    status_word{0x6041, 0, 2}, quick_stop_way{0x605A, 0, 2}, mode{0x6060, 0, 1}, counts{0x6064},
    max_following{0x6065}, max_torque{0x6072, 0, 2}, rated_torque{0x6076}, cycle_time{0x60C2, 1, 1},
    cycle_power{0x60C2, 2, 1};
}  // namespace object

/// The host's heartbeat comes with every so many commands; a drive that misses it for so long
/// stops.
inline constexpr int commands_a_heartbeat = 5;
inline constexpr int max_host_silence_ms = 20;
inline constexpr int ms_a_drive_heartbeat = 100;

/// Bits that so many drives on one bus need in each millisecond at the most: the SYNC; from each
/// drive 8 bytes and to it 4; heartbeats.
[[nodiscard]] constexpr double bits_a_cycle(int drives) {
  const double heartbeats = static_cast<double>(canopen::max_bits(1)) *
                            (1.0 / commands_a_heartbeat + 1.0 * drives / ms_a_drive_heartbeat);
  return canopen::max_bits(0) + drives * (canopen::max_bits(8) + canopen::max_bits(4)) + heartbeats;
}

}  // namespace tuina::hardware::cia402
