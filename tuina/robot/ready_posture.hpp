// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"

namespace tuina::robot {

/// Both tools held before the person with nothing near: the start and end of every massage. The
/// tools are mirror images, and so are the arms where they are built so.
[[nodiscard]] PerArm<JointVector> ready_posture(const ArmTable& table, const RobotMount& mount);

/// Joint angles of the mirror image of a posture: the right arm holds mirrored(q) where the left
/// holds q. True of arms that are mounted as each other's mirror image and whose axes at q = 0
/// stand on a plane of their own or lie in it; of others it is the likeness that a search begins
/// from.
[[nodiscard]] JointVector mirrored(const ArmTable& table, const RobotMount& mount,
                                   const JointVector& q_rad) noexcept;

}  // namespace tuina::robot
