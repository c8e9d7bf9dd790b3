// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/core/result.hpp"
#include "tuina/hardware/can/can_bus.hpp"
#include "tuina/hardware/can/cia402.hpp"
#include "tuina/hardware/can/drive_device.hpp"

namespace tuina::hardware {

/// @{
/// One entry of a node's dictionary by SDO. Fails with Fault::device where the node does not answer
/// within 0.6 s, or refuses.
[[nodiscard]] Result<std::uint32_t> read_object(CanBus& bus, std::uint8_t node,
                                                const canopen::Object& object);
[[nodiscard]] Result<void> write_object(CanBus& bus, std::uint8_t node,
                                        const canopen::Object& object, std::uint32_t value);
/// @}

/// Who a drive is and where it stands.
struct FoundDrive {
  std::uint32_t vendor = 0, product = 0, serial = 0;
  cia402::State state = cia402::State::not_ready;
  double joint_rad = 0.0;
};
/// Only asks. Fails with Fault::device where the node is no drive of CiA 402, or where its motor
/// has another rated torque than the file says.
[[nodiscard]] Result<FoundDrive> find_drive(CanBus& bus, const DriveDevice& device);

/// What a drive may do, whatever it is ordered.
struct DriveLimits {
  double max_torque_nm = 0.0;      ///< of the joint
  double max_following_rad = 0.0;  ///< between where it should be and is, while it holds a position
};
/// Makes the drive ready for cycles, at rest: limits, PDOs, what it does when its host falls
/// silent. A fault from before is reset once.
[[nodiscard]] Result<void> set_up_drive(CanBus& bus, const DriveDevice& device,
                                        const DriveLimits& limits);

}  // namespace tuina::hardware
