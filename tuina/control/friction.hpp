// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_table.hpp"

namespace tuina::control {

/// Feeds a share of the gears' Coulomb friction forward. Its direction comes from the way turned,
/// not from the speed, [dahl1968]: a gear first winds up like a spring and only then slips. So
/// there is no chatter where the encoder cannot see the speed, and a reversal is followed as it
/// happens.
class FrictionCompensation {
 public:
  /// A share of one would push the arm by itself where the friction is smaller than believed.
  FrictionCompensation(const robot::ArmTable& table, double share = 0.8,
                       double windup_rad = 0.5e-3) noexcept
      : table_(table), share_(share), windup_rad_(windup_rad) {}

  void start(const JointVector& q_rad) noexcept;
  [[nodiscard]] JointVector step(const JointVector& q_rad) noexcept;

 private:
  robot::ArmTable table_;
  double share_;
  double windup_rad_;
  JointVector q_rad_;
  JointVector wound_;  // share of the Coulomb friction, -1 to 1
};

}  // namespace tuina::control
