// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/io/toml_reader.hpp"

namespace tuina::hardware {

/// The drive of one joint, a [[arm.left.joint]] of a device file.
struct DriveDevice {
  std::string bus;  ///< its CAN interface
  std::uint8_t node = 0;
  int counts_per_turn = 0;       ///< of the motor, four edges to each line of its encoder
  double gear = 1.0;             ///< turns of the motor for one of the joint
  double rated_torque_nm = 0.0;  ///< of the motor: its torque constant by its rated current
  int zero_count = 0;            ///< where the joint is at 0
  bool reversed = false;         ///< counts fall while the joint's angle rises
  [[nodiscard]] double counts_per_rad() const noexcept;            ///< of the joint, signed
  [[nodiscard]] double rated_torque_at_joint_nm() const noexcept;  ///< signed likewise
};

/// An arm whose joints are drives of CiA 402, kind "cia402", from its shoulder on.
struct DrivenArm {
  int bits_per_s = 1'000'000;  ///< of its buses
  std::vector<DriveDevice> joints;
};

/// Reads one arm's section; what is wrong is collected in the table's faults.
[[nodiscard]] DrivenArm read_driven_arm(const TomlTable& table);

/// What one bus has to carry.
struct BusLoad {
  std::string bus;
  int drives = 0;
  double share = 0.0;  ///< of what it can, when every bit that may be stuffed is; above 1 it cannot
};
/// Of each bus that these arms name, in the order in which they name them first.
[[nodiscard]] std::vector<BusLoad> bus_loads(const PerArm<DrivenArm>& arms);
/// What is wrong with these arms as a whole: a bus that carries too much, a node named twice, too
/// many buses; empty where nothing is.
[[nodiscard]] std::string fault_of(const PerArm<DrivenArm>& arms);

}  // namespace tuina::hardware
