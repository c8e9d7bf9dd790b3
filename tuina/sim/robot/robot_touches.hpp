// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/touch.hpp"

namespace tuina::sim {

/// Standard deviations of the errors when a hand leads the tool onto marked spots.
struct TouchErrors {
  double hand_m = 1_mm;              ///< from the spot, along each axis
  double joint_zero_rad = 0.03_deg;  ///< per joint, the same in all touches
  double spot_m = 0.5_mm;            ///< of the recorded spot, along each axis
};

/// Simulates both arms led to the reachable spots of a board in place of a back (`rows` rows of
/// three), for a robot placed by `mount`. Touches for `calibrate --robot`, with errors.
[[nodiscard]] Result<std::vector<robot::Touch>> touch_board(const robot::ArmTable& table,
                                                            const robot::RobotMount& mount,
                                                            BodyPosture position, int rows,
                                                            const TouchErrors& errors,
                                                            std::uint64_t seed);

}  // namespace tuina::sim
