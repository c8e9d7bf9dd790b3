// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tuina/core/geometry.hpp"

namespace tuina {

/// One turn of the control loop: 1 kHz.
inline constexpr double control_period_s = 1e-3;

/// The two arms of a robot.
enum class Arm : std::uint8_t { left, right };
inline constexpr std::array<Arm, 2> both_arms = {Arm::left, Arm::right};
/// "left" or "right".
[[nodiscard]] constexpr const char* name_of(Arm arm) {
  return arm == Arm::left ? "left" : "right";
}

/// The other one of the two.
[[nodiscard]] constexpr Arm other(Arm arm) {
  return arm == Arm::left ? Arm::right : Arm::left;
}

/// One T per arm, indexed by `Arm`.
template <typename T>
struct PerArm {
  std::array<T, 2> of = {};
  /// @{
  /// What belongs to an arm.
  [[nodiscard]] T& operator[](Arm arm) { return of[static_cast<std::size_t>(arm)]; }
  [[nodiscard]] const T& operator[](Arm arm) const { return of[static_cast<std::size_t>(arm)]; }
  /// @}
};

/// One number per joint. At most seven, so that arms of six and seven joints share the code without
/// heap.
inline constexpr int max_joints = 7;
/// @{
/// One number per joint, and a matrix of such rows and columns.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_joints, 1>;
using JointMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_joints, max_joints>;
/// @}

/// Force and torque of the environment on the robot, the torque about the tool's origin; the name
/// of the variable says along which axes.
struct Wrench {
  Vector3 force_n = Vector3::Zero();
  Vector3 torque_nm = Vector3::Zero();
};

/// State of one arm in one millisecond, from its sensors.
struct ArmState {
  double time_s = 0.0;
  JointVector q_rad;
  JointVector dq_rad_per_s;
  Transform base_from_tool = Transform::Identity();
  Wrench contact_in_base;
};

}  // namespace tuina
