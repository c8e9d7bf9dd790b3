// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/cia402.hpp"

#include <array>

namespace tuina::hardware::cia402 {

State state_of(std::uint16_t status) noexcept {
  // Bit 6: disabled; 5: no quick stop; 3: fault; 2, 1, 0: enabled, switched on, ready.
  switch (status & 0x4FU) {
    case 0x40:
      return State::switch_on_disabled;
    case 0x0F:
      return State::fault_reaction;
    case 0x08:
      return State::fault;
    default:
      break;
  }
  switch (status & 0x6FU) {
    case 0x21:
      return State::ready_to_switch_on;
    case 0x23:
      return State::switched_on;
    case 0x27:
      return State::enabled;
    case 0x07:
      return State::quick_stop;
    default:
      return State::not_ready;
  }
}

const char* name_of(State state) noexcept {
  constexpr std::array names = {
      "not ready",         "switch on disabled", "ready to switch on",   "switched on",
      "operation enabled", "quick stop active",  "stopping for a fault", "fault"};
  return names[static_cast<std::size_t>(state)];
}

std::uint16_t towards_enabled(State state) noexcept {
  switch (state) {
    case State::switch_on_disabled:
      return control::shutdown;
    case State::ready_to_switch_on:
      return control::switch_on;
    case State::switched_on:
    case State::enabled:
      return control::enable;
    default:
      return control::disable;
  }
}

std::optional<Told> told_of(const can_frame& frame) noexcept {
  if (frame.can_dlc != 8) return std::nullopt;
  return Told{.status = static_cast<std::uint16_t>(canopen::number_at(frame, 0, 2)),
              .counts = static_cast<std::int32_t>(canopen::number_at(frame, 2, 4)),
              .permille = static_cast<std::int16_t>(canopen::number_at(frame, 6, 2))};
}

can_frame encode(std::uint8_t node, const Told& told) noexcept {
  can_frame frame = canopen::frame_for(canopen::Kind::told, node, 8);
  canopen::put(frame, 0, 2, told.status);
  canopen::put(frame, 2, 4, static_cast<std::uint32_t>(told.counts));
  canopen::put(frame, 6, 2, static_cast<std::uint16_t>(told.permille));
  return frame;
}

can_frame encode(std::uint8_t node, const Ordered& ordered) noexcept {
  can_frame frame = canopen::frame_for(canopen::Kind::ordered, node, 4);
  canopen::put(frame, 0, 2, ordered.control);
  canopen::put(frame, 2, 2, static_cast<std::uint16_t>(ordered.permille));
  return frame;
}

can_frame placed(std::uint8_t node, std::int32_t counts) noexcept {
  can_frame frame = canopen::frame_for(canopen::Kind::placed, node, 4);
  canopen::put(frame, 0, 4, static_cast<std::uint32_t>(counts));
  return frame;
}

}  // namespace tuina::hardware::cia402
