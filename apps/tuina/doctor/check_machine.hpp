// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/progress.hpp"

namespace tuina::app {

/// One thing that tuina could use of this machine.
struct MachineCheck {
  std::string what;
  bool good = false;
  std::string finding;
  std::string remedy;  ///< for who needs it; empty where it is good
};

/// Cores, cameras, serial lines and CAN interfaces with the right to open them, what a real-time
/// thread may have, and how late this machine wakes up in so many `seconds` of sleeps.
[[nodiscard]] std::vector<MachineCheck> check_machine(double seconds, const Progress& progress);

}  // namespace tuina::app
