// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/obstacle.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::motion {

/// Arms that come nearer than this to each other, to the couch or to the robot's own body, or that
/// could not be halted before, stop; the deceleration is that of one arm.
inline constexpr double stopping_arm_distance_m = 25e-3;
inline constexpr double halting_m_per_s2 = 2.0;

/// Watches how near the arms are to each other and to what surrounds them, a millisecond at a time.
/// The plan keeps them apart; this is for an arm that somebody pushes, or that is not where its
/// plan has it. Real-time.
class ArmSeparation {
 public:
  explicit ArmSeparation(const PerArm<robot::ArmModel>& models,
                         std::vector<robot::Obstacle> obstacles = {})
      : models_(models), obstacles_(std::move(obstacles)) {}

  /// False when something is too near, or will be.
  [[nodiscard]] bool keeps(const robot::RobotReading& reading) noexcept;

  /// Between the surfaces of the arms as measured, in the last millisecond.
  [[nodiscard]] double apart_m() const noexcept { return apart_m_; }
  /// False when it was the other arm that one of them came too near to.
  [[nodiscard]] bool arms_keep() const noexcept { return arms_keep_; }

 private:
  PerArm<robot::ArmModel> models_;
  std::vector<robot::Obstacle> obstacles_;
  bool watching_ = false, arms_keep_ = true;
  double apart_m_ = 0.0;
  PerArm<robot::ArmModel::Kinematics> before_ = {};  ///< a millisecond ago
  PerArm<double> closing_m_per_s_ = {};              ///< how fast each comes nearer to the other
  PerArm<double> clear_m_ = {};                      ///< of couch and body
  PerArm<double> nearing_m_per_s_ = {};              ///< how fast each comes nearer to those
};

}  // namespace tuina::motion
