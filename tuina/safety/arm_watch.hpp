// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/guard.hpp"

namespace tuina::safety {

/// Turns the raw readings of one arm into what its guard sees, by a model and a zero of the wrist
/// sensor of its own. Nothing of it comes from the controller. Real-time: no heap, no exceptions.
class ArmWatch {
 public:
  explicit ArmWatch(const robot::ArmModel& model) noexcept : model_(model) {}

  /// `applied_nm` moved the arm since the last reading; empty at the first. Of the proposal two
  /// things count: when an approach begins, the wrist sensor is zeroed, by 3 N at most; and an arm
  /// without a spring is one that a hand leads, so more of its torque may go unexplained. A sensor
  /// whose torques are no numbers has no force either.
  [[nodiscard]] Observation observe(const robot::RobotReading& reading, Arm arm,
                                    const Proposal& proposal,
                                    const JointVector& applied_nm) noexcept;

 private:
  static constexpr std::size_t window = 20;  ///< ticks over which torques and motion are compared

  void compare(const robot::ArmDynamics& dynamics, const robot::ArmReading& reading,
               const Vector3& force_in_base_n, const JointVector& applied_nm,
               double share) noexcept;

  robot::ArmModel model_;
  Phase phase_ = Phase::free;
  bool started_ = false;
  Vector3 mean_in_tool_n_ = Vector3::Zero(), zero_in_tool_n_ = Vector3::Zero();

  std::array<JointVector, window> speeds_ = {}, unexplained_nm_ = {};
  std::size_t next_ = 0, filled_ = 0;
  double misfit_ = 0.0;  ///< the last one; a millisecond without the wrist's torques leaves it so
};

}  // namespace tuina::safety
