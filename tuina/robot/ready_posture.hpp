// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/obstacle.hpp"

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

/// How two arms that wait stand.
struct ReadyRoom {
  PerArm<double> off_m;         ///< of each tool from where its mount wants it to wait
  double between_arms_m = 0.0;  ///< from arm to arm
  PerArm<Clearances> clear;     ///< of each arm from the couch and the robot's own body
  [[nodiscard]] double min_m() const noexcept;
  /// What is nearest, as "the left arm 12 mm from the couch".
  [[nodiscard]] std::string nearest() const;
};
/// Tools farther off wait elsewhere than their mount says: it does not suit the arm.
inline constexpr double max_ready_off_m = 10e-3;

/// How the arms wait with the linear base at `rail_m`.
[[nodiscard]] ReadyRoom ready_room(const PerArm<ArmModel>& arms, const RobotMount& mount,
                                   const PerArm<JointVector>& ready_rad, double rail_m);

}  // namespace tuina::robot
