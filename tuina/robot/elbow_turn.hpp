// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/units.hpp"
#include "tuina/robot/arm_model.hpp"

namespace tuina::robot {

/// Postures that hold the tool's tip and axis where they are while the elbow turns about the line
/// from the shoulder to the tool, a few degrees apart and in order, `q_rad` among them; to either
/// side until a joint comes within the margin of its end.
[[nodiscard]] std::vector<JointVector> turn_elbow(const ArmModel& arm, double rail_m,
                                                  const JointVector& q_rad,
                                                  double limit_margin_rad = 3_deg);

}  // namespace tuina::robot
