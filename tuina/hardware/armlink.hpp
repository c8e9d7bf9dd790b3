// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "tuina/core/arm.hpp"

// The datagrams of armlink, version 1 (docs/armlink.md): what one arm and its host say to each
// other. Bytes to structs and back, nothing else; no heap.
namespace tuina::hardware::armlink {

inline constexpr std::uint8_t protocol_version = 1;
inline constexpr std::size_t ask_size = 20, hello_size = 292, command_size = 92, state_size = 268;
inline constexpr std::size_t max_size = hello_size;
/// Cycles without a command after which an arm under torque stops by itself.
inline constexpr int max_missed_cycles = 3;
/// Cycles between a state and the command in answer to it, beyond which the arm does not hear it.
inline constexpr int max_answer_age_cycles = 8;

enum class Kind : std::uint8_t { ask = 1, hello = 2, command = 3, state = 4 };
enum class Mode : std::uint8_t {
  idle = 0,        ///< brakes closed; the end of a session
  torque = 1,      ///< values are joint torques, Nm, gravity compensation included
  admittance = 2,  ///< reserved
  ready = 3,  ///< values are joint angles, rad, which the arm takes and holds by its own drives
};
[[nodiscard]] constexpr std::uint8_t bit_of(Mode mode) noexcept {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(mode));
}

/// Bits of `State::status`.
namespace status {
inline constexpr std::uint16_t stands = 1, stopped = 2, braked = 4, drive_fault = 8,
                               emergency_stop = 16;
}
/// Bits of `Hello::flags`.
namespace flag {
inline constexpr std::uint16_t has_rail = 1, simulated = 2, waits = 4, busy = 8,
                               measures_torque = 16;
}

/// A host's question who is there; changes nothing.
struct Ask {
  std::uint32_t session = 0, sequence = 0;
};
/// The answer to one question: what the arm is and can.
struct Hello {
  std::uint32_t session = 0, sequence = 0;  ///< those of the question
  std::uint8_t modes = 0;                   ///< `bit_of` each that it has
  std::uint16_t flags = 0;
  std::uint32_t cycle_us = 0;
  std::array<char, 24> name = {};  ///< ends with zeros
  JointVector max_torque_nm, max_speed_rad_per_s, min_rad, max_rad;
  double min_rail_m = 0.0, max_rail_m = 0.0;
  /// The name up to its first zero.
  [[nodiscard]] std::string_view called() const noexcept;
};
/// What the host asks of an arm in one cycle (docs/armlink.md).
struct Command {
  std::uint32_t session = 0, sequence = 0;
  std::uint32_t answers = 0;  ///< sequence of the state that it answers
  Mode mode = Mode::idle;
  bool brake = false;
  double rail_m = 0.0;  ///< where the linear base should be
  JointVector values;   ///< by the mode
};
/// What an arm says of itself in one cycle (docs/armlink.md).
struct State {
  std::uint32_t session = 0, sequence = 0;
  std::uint32_t answers = 0;  ///< sequence of the last command that was obeyed
  Mode mode = Mode::idle;
  std::uint16_t status = 0;
  double time_s = 0.0;         ///< the arm's own clock
  double wrench_time_s = 0.0;  ///< when the wrist sensor took its sample, by that clock
  double rail_m = 0.0;
  JointVector q_rad, dq_rad_per_s, tau_nm;
  Wrench wrench_in_tool;  ///< of the environment on the tool, the tool's weight included
};

/// What is wrong with a datagram.
enum class Spoilt : std::uint8_t {
  foreign,   ///< no armlink at all, or too short for it
  version,   ///< armlink of another version
  size,      ///< its length is not the one that it says, or not that of its kind
  kind,      ///< another kind than was asked for
  checksum,  ///< the check sum does not fit: bits have changed on the way
  value,     ///< a number that is not finite, an unknown mode, reserved bytes that are not zero
};
[[nodiscard]] constexpr const char* name_of(Spoilt spoilt) {
  constexpr std::array names = {"sends what is no armlink",
                                "speaks another version of armlink",
                                "sends datagrams of a wrong size",
                                "sends datagrams of a wrong kind",
                                "sends datagrams with wrong check sums",
                                "sends values that cannot be, such as numbers that are not finite"};
  return names[static_cast<std::size_t>(spoilt)];
}
template <typename T>
using Decoded = tl::expected<T, Spoilt>;
using Bytes = std::span<const std::byte>;

/// The kind of a whole datagram of this version.
[[nodiscard]] Decoded<Kind> kind_of(Bytes datagram) noexcept;

/// Only what `encode` writes is accepted, to the last bit.
[[nodiscard]] Decoded<Ask> decode_ask(Bytes datagram) noexcept;
[[nodiscard]] Decoded<Hello> decode_hello(Bytes datagram) noexcept;
[[nodiscard]] Decoded<Command> decode_command(Bytes datagram) noexcept;
[[nodiscard]] Decoded<State> decode_state(Bytes datagram) noexcept;

[[nodiscard]] std::array<std::byte, ask_size> encode(const Ask& ask) noexcept;
[[nodiscard]] std::array<std::byte, hello_size> encode(const Hello& hello) noexcept;
[[nodiscard]] std::array<std::byte, command_size> encode(const Command& command) noexcept;
[[nodiscard]] std::array<std::byte, state_size> encode(const State& state) noexcept;

}  // namespace tuina::hardware::armlink
