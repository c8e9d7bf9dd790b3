// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::control {

/// Readings of one arm to an `ArmState`: where the tool is, and the contact force in `base` without
/// the weight of the tool and the zero error of the sensor. A wild sample or two are replaced by
/// the last good one.
class ArmSense {
 public:
  explicit ArmSense(const robot::ArmModel& model) noexcept : model_(&model) {}

  [[nodiscard]] ArmState sense(const robot::ArmReading& reading, double time_s,
                               double rail_m) noexcept;

  /// In free air, before a contact: what the sensor says now, averaged over the last tenth of a
  /// second, counts as no contact from here on.
  void tare() noexcept { bias_ = mean_; }

 private:
  const robot::ArmModel* model_;
  bool started_ = false;
  int suspects_ = 0;
  Wrench last_;  // in tool, weight taken off
  Wrench mean_;  // the same, averaged
  Wrench bias_;  // in tool
};

}  // namespace tuina::control
