// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/touch.hpp"

namespace tuina::sim {

/// What goes wrong while a hand leads the tool onto marked spots; standard deviations.
struct TouchErrors {
  double hand_m = 1_mm;              ///< from the spot, along each axis
  double joint_zero_rad = 0.03_deg;  ///< of each joint, the same in all touches
  double spot_m = 0.5_mm;            ///< of the place that is written down, along each axis
};

/// Spots on a board that stands where a back would be, and both arms led to those they reach:
/// `rows` rows of three. The robot stands as `mount` says. Rows for `calibrate --robot`, with the
/// errors in them.
[[nodiscard]] Result<std::vector<robot::Touch>> touch_board(const robot::ArmTable& table,
                                                            const robot::RobotMount& mount,
                                                            Position position, int rows,
                                                            const TouchErrors& errors,
                                                            std::uint64_t seed);

}  // namespace tuina::sim
