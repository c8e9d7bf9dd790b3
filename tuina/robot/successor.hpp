// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/robot/description.hpp"

namespace tuina::robot {

/// The seven-joint arm of the thesis' successor: the six-joint arm with a wrist that bends about
/// two axes. The thesis names the number of joints only; what the second bend weighs is assumed.
[[nodiscard]] ArmTable successor_arm() noexcept;

/// The whole successor: an omnidirectional base on four wheels, a waist of three joints, a head of
/// two, two arms of seven, these ones: the 23 of [thesis], and the base's place and heading
/// besides, on which the wheels act. `base` is the floor beneath the base's middle at zero, x
/// ahead, z up. Markers `left_shoulder` and `right_shoulder` are DH frames 0 of the arms. Lengths
/// and masses of base, waist and head are assumptions; the thesis prints none.
[[nodiscard]] Description successor_robot(const PerArm<ArmTable>& arms = {
                                              .of = {successor_arm(), successor_arm()}});

/// Where the arms hang for joint values of a description with shoulder markers: what `ArmModel`
/// wants to know of the rest of the robot. The rail of such a mount stands still.
[[nodiscard]] RobotMount mount_in(const Description& robot, const std::vector<double>& q);

/// Speeds of the wheels front left, front right, rear left, rear right (rad/s) that move the base
/// ahead, to the left and round, [muir1987]: mecanum wheels whose rollers lie at 45 degrees.
[[nodiscard]] std::array<double, 4> wheel_speeds(double ahead_m_per_s, double left_m_per_s,
                                                 double turn_rad_per_s) noexcept;

}  // namespace tuina::robot
