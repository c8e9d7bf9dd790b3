// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/drive_watch.hpp"
#include "tuina/safety/guard.hpp"
#include "tuina/safety/swing.hpp"

namespace tuina::safety {

/// Turns the raw readings of one arm into what its guard sees, by a model and a zero of the wrist
/// sensor of its own. Nothing of it comes from the controller. Real-time: no heap, no exceptions.
class ArmWatch {
 public:
  /// Has a copy of the model.
  explicit ArmWatch(const robot::ArmModel& model) noexcept
      : model_(model), drives_(model.table().torque_limits_nm()) {}

  /// What the guard sees of one arm in this millisecond. `applied_nm`: torques that moved the arm
  /// since the last reading; empty at the first one.
  ///
  /// Wrist: the tool's weight and a zero are taken off the force. The zero is the mean of the last
  /// 0.1 s, taken when the proposal begins an approach; it is 3 N long at most, and 1 N more for
  /// each minute watched. `zero_jump_n` is how far that mean lies from the zero in use, beyond a
  /// drift of 1 N a minute; it is taken then and at the first look at an arm in free motion. A
  /// sensor whose torques are not finite has no force either.
  ///
  /// Torques: the momentum of each joint [deluca2006]. What drive, wrist and weight should have
  /// added to it and what was measured may differ in each millisecond by friction and a share of
  /// the drive's limit; a larger share where the proposal has no spring, since a hand then leads
  /// the arm. The rest is summed up [page1954] and compared with what coarse encoders, a badly
  /// timed drive, and a gear that takes up a change of torque late and swings after it, may feign.
  /// Torques that the drives measure are compared with the commanded ones, too (`DriveWatch`).
  [[nodiscard]] Observation observe(const robot::RobotReading& reading, Arm arm,
                                    const Proposal& proposal,
                                    const JointVector& applied_nm) noexcept;

 private:
  void compare(const robot::ArmDynamics& dynamics, const robot::ArmReading& reading,
               const Vector3& force_in_base_n, const JointVector& applied_nm, double passed_s,
               double share) noexcept;
  void weigh(const robot::ArmDynamics& dynamics) noexcept;
  void count_repeats(const robot::ArmReading& reading) noexcept;
  [[nodiscard]] bool steps(const robot::ArmReading& reading) noexcept;
  void zero(Phase phase) noexcept;

  robot::ArmModel model_;
  DriveWatch drives_;
  Phase phase_ = Phase::free;
  bool started_ = false, looked_ = false;
  double watched_s_ = 0.0, zeroed_s_ = 0.0, zero_jump_n_ = 0.0;
  Vector3 mean_in_tool_n_ = Vector3::Zero(), zero_in_tool_n_ = Vector3::Zero();

  std::uint64_t tick_ = 0;
  JointVector dq_rad_per_s_;
  JointVector lagged_nm_;                     ///< of the drives, as late as speeds and wrist are
  std::array<Swing, max_joints> torques_nm_;  ///< of the drives, as late
  std::array<Swing, max_joints> unexplained_nms_;  ///< momentum
  robot::Vector6 wrench_ =
      robot::Vector6::Zero();  ///< on the tool, in `base`, without wild samples
  /// Momentum of each joint that nothing explains, in N m s: too little of it in the direction of
  /// its axis, and against it.
  JointVector missing_ahead_, missing_back_;
  double misfit_ = 0.0;
  int weak_joint_ = -1;
  JointVector unexplained_nm_;  ///< torque of each joint that does not show in the motion

  Wrench sample_;
  double sample_time_s_ = std::numeric_limits<double>::quiet_NaN();
  int repeats_ = -1;                      ///< of the sample; the first one repeats none
  std::array<double, 7> changes_n_ = {};  ///< from sample to sample, the newest last
};

}  // namespace tuina::safety
