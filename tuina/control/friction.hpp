// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/robot/arm_table.hpp"

namespace tuina::control {

/// Feeds a share of the gears' Coulomb friction forward. Its direction comes from the way turned,
/// not from the speed, [dahl1968]: a gear first winds up like a spring and only then slips. So
/// there is no chatter where the encoder cannot see the speed, and a reversal is followed as it
/// happens.
///
/// How much friction there is, the table knows to a fifth at best, and what it says too much pushes
/// the arm by itself. So it is learned: moved to and fro in free air, each joint's torque left over
/// by the model is a friction that follows the direction plus an error of gravity that does not.
class FrictionCompensation {
 public:
  struct Options {
    double share = 0.92;          ///< of what was learned; one would leave no margin
    double share_of_table = 0.6;  ///< before anything was learned
    double windup_rad = 0.3e-3;   ///< from this the gear slips
  };

  FrictionCompensation(const robot::ArmTable& table, const Options& options) noexcept;

  void start(const JointVector& q_rad) noexcept;
  /// Torque for this tick; call it in every tick, it follows the way turned.
  [[nodiscard]] JointVector step(const JointVector& q_rad) noexcept;

  void begin_learning() noexcept;
  /// `rest_nm`: the torque given less gravity, coupling and inertia.
  void learn(const JointVector& rest_nm, const JointVector& dq_rad_per_s) noexcept;
  void end_learning() noexcept;

  [[nodiscard]] const JointVector& coulomb_nm() const noexcept { return coulomb_nm_; }

 private:
  struct Sums {
    double n = 0.0, w = 0.0, ww = 0.0, r = 0.0, wr = 0.0;
  };
  robot::ArmTable table_;
  Options options_;
  JointVector coulomb_nm_;  // what is fed forward when wound up
  JointVector q_rad_;
  JointVector wound_;  // share of the Coulomb friction, -1 to 1
  std::array<Sums, max_joints> sums_ = {};
  bool learning_ = false;
};

}  // namespace tuina::control
