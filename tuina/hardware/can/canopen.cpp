// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/canopen.hpp"

#include <algorithm>
#include <array>

namespace tuina::hardware::canopen {
namespace {

constexpr unsigned node_bits = 7, node_mask = 0x7F;
// The first byte of an SDO frame: what is asked, and how many of its four bytes count.
constexpr std::uint32_t ask_byte = 0x40, write_byte = 0x23, read_byte = 0x43, written_byte = 0x60,
                        refused_byte = 0x80, unused_shift = 2, unused_mask = 0x0C;

std::uint32_t unused(int bytes) {
  return static_cast<std::uint32_t>(4 - bytes) << unused_shift;
}

can_frame sdo(Kind kind, std::uint8_t node, std::uint32_t first, std::uint16_t index,
              std::uint8_t sub, std::uint32_t value) noexcept {
  can_frame frame = frame_for(kind, node, 8);
  put(frame, 0, 1, first);
  put(frame, 1, 2, index);
  put(frame, 3, 1, sub);
  put(frame, 4, 4, value);
  return frame;
}

}  // namespace

std::uint32_t number_at(const can_frame& frame, int at, int bytes) noexcept {
  std::uint32_t value = 0;
  for (int i = bytes; i > 0; --i) value = value << 8U | frame.data[at + i - 1];
  return value;
}

void put(can_frame& frame, int at, int bytes, std::uint32_t value) noexcept {
  for (int i = 0; i < bytes; ++i, value >>= 8U)
    frame.data[at + i] = static_cast<std::uint8_t>(value & 0xFFU);
}

Address address_of(const can_frame& frame) noexcept {
  if (frame.can_id > CAN_SFF_MASK) return {};
  const auto kind = static_cast<Kind>(frame.can_id & ~node_mask);
  const auto node = static_cast<std::uint8_t>(frame.can_id & node_mask);
  constexpr std::array known = {Kind::emergency, Kind::told,     Kind::ordered,  Kind::placed,
                                Kind::answer,    Kind::question, Kind::heartbeat};
  if (frame.can_id == 0) return {.kind = Kind::network, .node = 0};
  if (std::find(known.begin(), known.end(), kind) == known.end()) return {};
  if (node == 0 && kind != Kind::emergency) return {};
  return {.kind = kind, .node = node};
}

can_frame frame_for(Kind kind, std::uint8_t node, std::uint8_t bytes) noexcept {
  static_assert(static_cast<unsigned>(Kind::told) >> node_bits == 3);
  can_frame frame = {};
  frame.can_id = static_cast<canid_t>(kind) | node;
  frame.can_dlc = bytes;
  return frame;
}

can_frame ask(std::uint8_t node, const Object& object) noexcept {
  return sdo(Kind::question, node, ask_byte, object.index, object.sub, 0);
}

can_frame write(std::uint8_t node, const Object& object, std::uint32_t value) noexcept {
  if (object.bytes < 4) value &= (1U << 8U * object.bytes) - 1U;
  return sdo(Kind::question, node, write_byte | unused(object.bytes), object.index, object.sub,
             value);
}

std::optional<Answer> answer_of(const can_frame& frame) noexcept {
  if (address_of(frame).kind != Kind::answer || frame.can_dlc != 8) return std::nullopt;
  Answer answer{.index = static_cast<std::uint16_t>(number_at(frame, 1, 2)),
                .sub = frame.data[3],
                .value = number_at(frame, 4, 4)};
  const std::uint32_t first = frame.data[0];
  if (first == refused_byte) return answer;
  if (first == written_byte && answer.value == 0) {
    answer.kind = Answer::Kind::written;
    return answer;
  }
  if ((first & ~unused_mask) != read_byte) return std::nullopt;
  answer.kind = Answer::Kind::read;
  answer.bytes = static_cast<std::uint8_t>(4 - ((first & unused_mask) >> unused_shift));
  // What lies behind the number means nothing.
  answer.value = number_at(frame, 4, answer.bytes);
  return answer;
}

can_frame encode(std::uint8_t node, const Answer& answer) noexcept {
  std::uint32_t first = refused_byte;
  if (answer.kind == Answer::Kind::written) first = written_byte;
  if (answer.kind == Answer::Kind::read) first = read_byte | unused(answer.bytes);
  return sdo(Kind::answer, node, first, answer.index, answer.sub, answer.value);
}

const char* meaning_of_refusal(std::uint32_t code) noexcept {
  switch (code) {
    case 0x05040000:
      return "it took too long";
    case 0x06010000:
    case 0x06010002:
      return "it cannot be written";
    case 0x06020000:
    case 0x06090011:
      return "it has no such object";
    case 0x06040041:
    case 0x06040042:
      return "it cannot be part of a PDO, or the PDO is full";
    case 0x06070010:
      return "it has another size";
    case 0x06090030:
    case 0x06090031:
    case 0x06090032:
      return "the value is out of its range";
    case 0x08000022:
      return "not in its present state";
    default:
      return "its manual says why";
  }
}

std::optional<NodeState> heartbeat_of(const can_frame& frame) noexcept {
  if (address_of(frame).kind != Kind::heartbeat || frame.can_dlc != 1) return std::nullopt;
  return static_cast<NodeState>(frame.data[0]);
}

can_frame heartbeat(std::uint8_t node, NodeState state) noexcept {
  can_frame frame = frame_for(Kind::heartbeat, node, 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

can_frame network(Network order, std::uint8_t node) noexcept {
  can_frame frame = frame_for(Kind::network, 0, 2);
  frame.data[0] = static_cast<std::uint8_t>(order);
  frame.data[1] = node;
  return frame;
}

can_frame sync() noexcept {
  return frame_for(Kind::emergency, 0, 0);
}

std::optional<std::uint16_t> emergency_of(const can_frame& frame) noexcept {
  const Address address = address_of(frame);
  if (address.kind != Kind::emergency || address.node == 0 || frame.can_dlc != 8)
    return std::nullopt;
  return static_cast<std::uint16_t>(number_at(frame, 0, 2));
}

const char* meaning_of_emergency(std::uint16_t code) noexcept {
  if (code == 0x8611) return "following error";
  if (code == 0x8130) return "it heard no heartbeat of its host";
  if (code == 0x8140) return "its bus was off";
  switch (code >> 12U) {
    case 0x2:
      return "current";
    case 0x3:
      return "voltage";
    case 0x4:
      return "temperature";
    case 0x5:
      return "its electronics";
    case 0x6:
      return "its firmware or parameters";
    case 0x7:
      return "motor, encoder or brake";
    case 0x8:
      return "communication or control";
    default:
      return "its manual says of what";
  }
}

}  // namespace tuina::hardware::canopen
