// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/arm.hpp"

namespace tuina::safety {

/// Tells a motor that turns the other way than it is told from somebody who pushes against the arm.
/// Both leave the same momentum unexplained. But only the motor stops when its joint is told
/// nothing for some milliseconds; whoever pushes goes on. A motor that stops is told nothing any
/// more. Real-time: no heap, no exceptions.
class MotorTrial {
 public:
  /// What the torques of the last millisecond should have done to each joint and did not, as a
  /// torque, and the torques themselves; nothing is learnt where they are of different sizes.
  /// `suspect` is the joint whose drive alone would explain it, -1 for none; each is tried once,
  /// and only where about twice its torque is missing.
  void look(const JointVector& unexplained_nm, const JointVector& applied_nm, int suspect) noexcept;

  /// The joint that is to be told nothing; -1: none.
  [[nodiscard]] int silenced_joint() const noexcept { return joint_; }

 private:
  JointVector missing_nm_, told_nm_;  ///< mean of the last milliseconds before a trial
  JointVector tried_;                 ///< 1 where a joint has been tried
  double left_share_ = 0.0;           ///< of that, while the joint is told nothing; a mean
  int joint_ = -1, ticks_ = 0;
};

}  // namespace tuina::safety
