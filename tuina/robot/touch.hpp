// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/arm.hpp"

namespace tuina::robot {

/// A hand has led the sphere of an arm onto a marked spot of known place, and the joints told where
/// they are.
struct Touch {
  Arm arm = Arm::left;
  double rail_m = 0.0;
  JointVector q_rad;
  Vector3 spot_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitZ();  ///< unit, out of the surface that bears the spot
};

}  // namespace tuina::robot
