// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>

#include <cstdint>
#include <optional>

// The frames of CANopen [cia301] that a host and its drives say to each other, with the identifiers
// that every node has from its maker. Bytes to structs and back, nothing else; no heap.
namespace tuina::hardware::canopen {

/// Nodes have numbers from 1 to this.
inline constexpr int max_node = 127;
/// The host's own, so no drive has it.
inline constexpr std::uint8_t host_node = 127;

/// What a frame is for, by its identifier; the value is that of node 0.
enum class Kind : std::uint16_t {
  network = 0x000,    ///< NMT: starts, stops and resets nodes
  emergency = 0x080,  ///< of a node; of node 0 it is the SYNC of all
  told = 0x180,       ///< TPDO 1, what a node tells
  ordered = 0x200,    ///< RPDO 1, what a node is ordered
  placed = 0x300,     ///< RPDO 2
  answer = 0x580,     ///< SDO, from the node
  question = 0x600,   ///< SDO, to the node
  heartbeat = 0x700,
  foreign = 0xFFFF,  ///< none of these
};
/// Whose frame it is, and what for.
struct Address {
  Kind kind = Kind::foreign;
  std::uint8_t node = 0;
};
/// Foreign are also frames with long identifiers, remote requests and what the kernel says of
/// errors.
[[nodiscard]] Address address_of(const can_frame& frame) noexcept;
/// A frame of so many bytes, all zero.
[[nodiscard]] can_frame frame_for(Kind kind, std::uint8_t node, std::uint8_t bytes) noexcept;

/// One entry of a node's dictionary.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bytes = 4;  ///< 1, 2 or 4
};
/// @{
/// SDO, expedited: questions to a node.
[[nodiscard]] can_frame ask(std::uint8_t node, const Object& object) noexcept;
[[nodiscard]] can_frame write(std::uint8_t node, const Object& object,
                              std::uint32_t value) noexcept;
/// @}

/// What a node answers to an SDO question.
struct Answer {
  enum class Kind : std::uint8_t { written, read, refused };
  Kind kind = Kind::refused;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bytes = 0;   ///< of what was read
  std::uint32_t value = 0;  ///< that was read, or why it was refused
};
/// Nothing where the frame is no expedited answer.
[[nodiscard]] std::optional<Answer> answer_of(const can_frame& frame) noexcept;
[[nodiscard]] can_frame encode(std::uint8_t node, const Answer& answer) noexcept;
/// Why a question was refused, for people.
[[nodiscard]] const char* meaning_of_refusal(std::uint32_t code) noexcept;

/// What a node does in the network.
enum class NodeState : std::uint8_t {
  booted = 0,
  stopped = 4,
  operational = 5,
  preoperational = 127
};
/// Nothing where the frame is no heartbeat.
[[nodiscard]] std::optional<NodeState> heartbeat_of(const can_frame& frame) noexcept;
[[nodiscard]] can_frame heartbeat(std::uint8_t node, NodeState state) noexcept;
/// What a node is told to do in the network.
enum class Network : std::uint8_t { start = 1, stop = 2, prepare = 128, reset = 129 };
[[nodiscard]] can_frame network(Network order, std::uint8_t node) noexcept;
/// All drives take over what they were ordered, and tell what they measure, at this moment.
[[nodiscard]] can_frame sync() noexcept;

/// The error code of an emergency, 0 when an error has gone; nothing where the frame is none.
[[nodiscard]] std::optional<std::uint16_t> emergency_of(const can_frame& frame) noexcept;
/// For people: the group of the code, [cia402] names them.
[[nodiscard]] const char* meaning_of_emergency(std::uint16_t code) noexcept;

/// Bits on the wire of a frame with so much data, when every bit that may be stuffed is.
[[nodiscard]] constexpr int max_bits(int bytes) {
  constexpr int stuffed_frame = 34, unstuffed_end = 13;
  const int stuffed = stuffed_frame + 8 * bytes;
  return stuffed + (stuffed - 1) / 4 + unstuffed_end;
}

/// @{
/// Numbers in frames are little-endian.
[[nodiscard]] std::uint32_t number_at(const can_frame& frame, int at, int bytes) noexcept;
void put(can_frame& frame, int at, int bytes, std::uint32_t value) noexcept;
/// @}

}  // namespace tuina::hardware::canopen
