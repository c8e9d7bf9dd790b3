// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"

namespace tuina::robot {

/// An arm of a table that is only computed: the motion which torques and the force at its wrist
/// would give it, without friction. An arm that takes places and no torques follows it, and so
/// yields like one that takes torques: mass * ddq = torque - coriolis - gravity + jacobian^T *
/// wrench, the admittance of [hogan1985]. No heap, no exceptions.
class VirtualArm {
 public:
  /// Has a copy of the model.
  explicit VirtualArm(const ArmModel& model) noexcept : model_(model) {}

  /// At rest there.
  void stand(const JointVector& q_rad) noexcept;
  /// A millisecond under these torques. `wrench_in_tool` is what the wrist sensor says, the weight
  /// of the tool included; where it is not `felt`, it is not known. Then the tool goes no farther
  /// the way it presses, along its shaft; likewise where the sensor says that something pulls it
  /// that way, which no body does.
  void step(const JointVector& torque_nm, const Wrench& wrench_in_tool, bool felt,
            double rail_m) noexcept;

  [[nodiscard]] const ArmModel& model() const noexcept { return model_; }  ///< the copy
  /// @{
  /// Where its joints are, and how fast.
  [[nodiscard]] const JointVector& q_rad() const noexcept { return q_rad_; }
  [[nodiscard]] const JointVector& dq_rad_per_s() const noexcept { return dq_rad_per_s_; }
  /// @}

 private:
  void keep_from_pressing(const ArmDynamics& dynamics) noexcept;
  void keep_limits() noexcept;

  ArmModel model_;
  JointVector q_rad_, dq_rad_per_s_;
};

}  // namespace tuina::robot
