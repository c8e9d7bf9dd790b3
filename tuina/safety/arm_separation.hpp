// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/obstacle.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::safety {

/// Arms stop when they come nearer than this to each other, to the couch or to the robot's body, or
/// when braking at `halting_m_per_s2` per arm would end nearer.
inline constexpr double stopping_arm_distance_m = 25e-3;
inline constexpr double halting_m_per_s2 = 2.0;

/// Monitors the distances between the arms and to their surroundings at 1 kHz. The plan keeps them
/// apart; the monitor catches an arm that is pushed or off its plan. Real-time.
class ArmSeparation {
 public:
  /// Both arms and what they must not touch.
  explicit ArmSeparation(const PerArm<robot::ArmModel>& models,
                         std::vector<robot::Obstacle> obstacles = {}) noexcept
      : models_(models), obstacles_(std::move(obstacles)) {}

  /// False when a distance is too small or cannot be kept by braking.
  [[nodiscard]] bool keeps(const robot::RobotReading& reading) noexcept;

  /// Distance between the surfaces of the arms at the last reading.
  [[nodiscard]] double apart_m() const noexcept { return apart_m_; }
  /// False when the arms were too close to each other at the last reading, or one was not known.
  [[nodiscard]] bool arms_keep() const noexcept { return arms_keep_; }

 private:
  PerArm<robot::ArmModel> models_;
  std::vector<robot::Obstacle> obstacles_;
  bool watching_ = false, arms_keep_ = true;
  double apart_m_ = 0.0;
  std::uint64_t tick_ = 0;                           ///< of the last reading that places both arms
  PerArm<robot::ArmModel::Kinematics> before_ = {};  ///< kinematics in it
  PerArm<double> closing_m_per_s_ = {};  ///< closing speed of each arm towards the other
  PerArm<double> clear_m_ = {};          ///< distance to couch and robot body
  PerArm<double> nearing_m_per_s_ = {};  ///< closing speed towards couch and robot body
};

}  // namespace tuina::safety
