// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/robot/arm_table.hpp"

namespace tuina::control {

/// Feeds a share of the gears' Coulomb friction forward. Its sign follows the travel, not the speed
/// [dahl1968], since a gear winds up like a spring before it slips: no chatter at speeds below the
/// encoder's resolution, and reversals are followed at once.
///
/// The table knows friction to 20 % at best, and over-compensation would move the arm. So it is
/// identified: each joint moves to and fro in free air, and its residual torque is split into a
/// part that follows the direction (friction) and a constant (gravity error).
class FrictionCompensation {
 public:
  /// How much of the friction is fed forward.
  struct Options {
    double share = 0.92;          ///< of the identified friction; 1 would leave no margin
    double share_of_table = 0.6;  ///< of the table's friction, before identification
    double windup_rad = 0.3e-3;   ///< travel at which the gear slips
  };

  /// Knows the friction of the table until it has learned.
  FrictionCompensation(const robot::ArmTable& table, const Options& options) noexcept;

  /// Begins at these joint angles, with every gear unwound.
  void start(const JointVector& q_rad) noexcept;
  /// Torque for this tick; must be called in every tick to follow the travel.
  [[nodiscard]] JointVector step(const JointVector& q_rad) noexcept;

  /// Forgets what was learned before, and begins to sum up.
  void begin_learning() noexcept;
  /// `rest_nm`: torque minus gravity, coupling and inertia.
  void learn(const JointVector& rest_nm, const JointVector& dq_rad_per_s) noexcept;
  /// Friction of each joint from the sums; it stays as it was where a joint was not moved to and
  /// fro.
  void end_learning() noexcept;

  [[nodiscard]] const JointVector& coulomb_nm() const noexcept { return coulomb_nm_; }

 private:
  struct Sums {
    double n = 0.0, w = 0.0, ww = 0.0, r = 0.0, wr = 0.0;
  };
  robot::ArmTable table_;
  Options options_;
  JointVector coulomb_nm_;  // feed-forward when fully wound up
  JointVector q_rad_;
  JointVector wound_;  // share of the Coulomb friction, -1 to 1
  std::array<Sums, max_joints> sums_ = {};
  bool learning_ = false;
};

}  // namespace tuina::control
