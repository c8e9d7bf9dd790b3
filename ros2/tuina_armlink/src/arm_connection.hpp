// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "armlink.h"

namespace tuina_armlink {

/// The host's side of armlink (docs/armlink.md) to one arm. Nothing of it waits but `ask`.
class ArmConnection {
 public:
  ArmConnection() = default;
  ArmConnection(const ArmConnection&) = delete;
  ArmConnection& operator=(const ArmConnection&) = delete;
  ~ArmConnection();

  /// False where the address is none of IPv4. Begins a session of its own.
  bool open(const std::string& address, int port);
  /// Who is there; nothing within half a second.
  std::optional<armlink_hello> ask();
  /// The newest state that has come since the last call; nothing where none has.
  std::optional<armlink_state> newest_state();
  /// In answer to the newest state. `rail_m`: where the linear base is to be; 0 without one.
  void command(armlink_mode mode, const std::vector<double>& values, double rail_m);

 private:
  /// The next datagram of this session, of that kind and no older than what came before.
  bool receive(int kind, std::vector<std::uint8_t>& bytes);
  int socket_ = -1;
  std::uint32_t session_ = 0, sequence_ = 0, heard_ = 0;
  bool any_heard_ = false;
};

}  // namespace tuina_armlink
