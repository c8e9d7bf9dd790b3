// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::control {

/// Converts readings of one arm to an `ArmState`: tool pose, and contact force in `base` without
/// tool weight and sensor offset. An outlier of one or two samples is replaced by the last good
/// one.
class ArmSense {
 public:
  /// The model must outlive it.
  explicit ArmSense(const robot::ArmModel& model) noexcept : model_(&model) {}

  /// The state of an arm from one reading; forces in tool become the contact's.
  [[nodiscard]] ArmState sense(const robot::ArmReading& reading, double time_s,
                               double rail_m) noexcept;

  /// Sets the sensor offset to the mean of the last tenth of a second; call in free air before a
  /// contact.
  void tare() noexcept { bias_ = mean_; }

 private:
  const robot::ArmModel* model_;
  bool started_ = false;
  int suspects_ = 0;
  Wrench last_;  // in tool, weight compensated
  Wrench mean_;  // low-passed last_
  Wrench bias_;  // sensor offset, in tool
};

}  // namespace tuina::control
