// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::session {

/// Arms that come nearer to each other than this, or that could not be halted before, stop; the
/// deceleration is that of one arm.
inline constexpr double stopping_arm_distance_m = 25e-3;
inline constexpr double halting_m_per_s2 = 2.0;

/// Watches the distance between the arms, a millisecond at a time. The plan keeps them apart; this
/// is for an arm that somebody pushes, or that is not where its plan has it. Real-time.
class ArmSeparation {
 public:
  explicit ArmSeparation(const PerArm<robot::ArmModel>& models) : models_(models) {}

  /// False when they are too near, or will be.
  [[nodiscard]] bool keeps(const robot::RobotReading& reading) noexcept;

  /// Between the surfaces of the arms as measured, in the last millisecond.
  [[nodiscard]] double apart_m() const noexcept { return apart_m_; }

 private:
  PerArm<robot::ArmModel> models_;
  bool watching_ = false;
  double apart_m_ = 0.0;
  PerArm<robot::ArmModel::Kinematics> before_ = {};  ///< a millisecond ago
  PerArm<double> closing_m_per_s_ = {};              ///< how fast each comes nearer to the other
};

}  // namespace tuina::session
