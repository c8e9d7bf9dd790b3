// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"

namespace tuina::robot {

/// Distance between the surfaces of two arms, each link a capsule between its joints; negative when
/// they overlap.
[[nodiscard]] double distance_between_m(const ArmModel& one, const ArmModel::Kinematics& one_pose,
                                        const ArmModel& other,
                                        const ArmModel::Kinematics& other_pose) noexcept;

}  // namespace tuina::robot
