// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/arm.hpp"

namespace tuina::safety {

/// Whether the drives of an arm give what they are told, by the torques that they measure. A fault
/// behind what is measured, such as a magnet that has grown weak, shows in the motion only.
/// Real-time: no heap, no exceptions.
class DriveWatch {
 public:
  /// One limit per joint.
  explicit DriveWatch(const JointVector& torque_limit_nm) noexcept : limit_nm_(torque_limit_nm) {}

  /// What was measured in a millisecond and what was commanded then; where one of them is missing
  /// there is nothing to compare. After milliseconds that nobody saw it `begins` anew.
  ///
  /// Both are smoothed alike. They may differ by scale and offset of such a measurement, by its
  /// noise, and by its delay as long as commands change. Scale and offset are learnt while all is
  /// well, and once they are known they may hardly change. What goes beyond is summed up
  /// [page1954].
  void compare(const JointVector& measured_nm, const JointVector& commanded_nm,
               bool begins) noexcept;

  /// Beyond 1 one of the drives is not believed.
  [[nodiscard]] double misfit() const noexcept { return misfit_; }
  /// The drive that is believed least, where it turns the other way than it is told; else -1.
  [[nodiscard]] int reversed_joint() const noexcept { return reversed_joint_; }

 private:
  JointVector limit_nm_;
  JointVector measured_nm_, commanded_nm_;  ///< smoothed
  JointVector known_nm_;     ///< by how much more is measured than commanded, as a rule
  JointVector known_at_nm_;  ///< mean command meanwhile
  JointVector beyond_;       ///< differences beyond the allowed, in shares of it, summed up
  double known_ticks_ = 0.0;
  double misfit_ = 0.0;
  int reversed_joint_ = -1;
};

}  // namespace tuina::safety
