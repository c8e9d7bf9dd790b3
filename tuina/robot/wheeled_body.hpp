// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/description.hpp"

namespace tuina::robot {

/// A robot on the wheeled body of the thesis' successor: an omnidirectional base on four wheels, a
/// waist of three joints, a head of two, and these arms, whose DH frames 0 stand so in the torso.
/// With arms of seven joints it has the 23 joints of [thesis], and the base's place and heading
/// besides, on which the wheels act. Its own frame is the floor beneath the base's middle at zero,
/// x ahead, z up; `place_robot` brings it into `base`. Markers `left_shoulder` and `right_shoulder`
/// are DH frames 0 of the arms. This body is no table but C++: one body is known, and the thesis
/// prints none of its lengths and masses, which are assumptions.
[[nodiscard]] Description wheeled_robot(const PerArm<ArmTable>& arms,
                                        const PerArm<Matrix3>& torso_from_shoulder);

/// Where the arms hang for joint values of a description with shoulder markers: what `ArmModel`
/// wants to know of the rest of the robot. The rail of such a mount stands still.
[[nodiscard]] RobotMount mount_in(const Description& robot, const std::vector<double>& q);

}  // namespace tuina::robot
