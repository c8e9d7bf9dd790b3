// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/obstacle.hpp"

namespace tuina::robot {

/// Distance between the surfaces of two arms, each link a capsule between its joints; negative when
/// they overlap.
[[nodiscard]] double distance_between_m(const ArmModel& one, const ArmModel::Kinematics& one_pose,
                                        const ArmModel& other,
                                        const ArmModel::Kinematics& other_pose) noexcept;

/// Between the surface of an arm, from its elbow on, and the obstacles of each kind; negative when
/// they overlap. The upper arm is not asked: the body carries it. Real-time.
[[nodiscard]] Clearances clearances(const ArmModel& arm, const ArmModel::Kinematics& pose,
                                    double rail_m, std::span<const Obstacle> obstacles) noexcept;

/// From a segment to a box about the origin; zero when they meet.
[[nodiscard]] double segment_to_box_m(const Vector3& from, const Vector3& to,
                                      const Vector3& half_edges_m) noexcept;

}  // namespace tuina::robot
