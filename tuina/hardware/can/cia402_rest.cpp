// SPDX-License-Identifier: Apache-2.0
// What a robot of drives does while nobody commands it.
#include <system_error>

#include "tuina/hardware/can/cia402_robot.hpp"

namespace tuina::hardware {

void Cia402Robot::say_heartbeat() noexcept {
  send_to_all_buses(canopen::heartbeat(canopen::host_node, canopen::NodeState::operational));
}

// Drives watch for their host from its first heartbeat on, brakes or no brakes. No SYNC is sent,
// upon which a drive would take over its last order.
void Cia402Robot::rest() noexcept {
  if (!standing_ || fault_ || commands_ == 0 || keeper_.joinable()) return;
  for (std::size_t k = 0; k < drives_.size(); ++k) send(k, drives_[k].shut_down());
  in_cycles_ = false;
  rests_ = true;
  try {
    keeper_ = std::thread([this] {
      constexpr std::chrono::milliseconds every(cia402::commands_a_heartbeat);
      while (rests_ && !fault_) {
        say_heartbeat();
        hear();
        note_faults();
        std::this_thread::sleep_for(every);
      }
    });
  } catch (const std::system_error&) {
    break_off("the ", "host", "has no thread left for its heartbeat");
  }
}

void Cia402Robot::end_rest() noexcept {
  rests_ = false;
  if (keeper_.joinable()) keeper_.join();
}

}  // namespace tuina::hardware
