// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "tuina/robot/position_drives.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/robot/virtual_arm.hpp"

namespace tuina::hardware {

/// Arms that take places and no torques, as the torque-controlled robot that everything else is
/// written for: each follows a `VirtualArm` of the robot's table, which obeys the torques that the
/// guard lets through and yields to the force at its wrist (docs/position_arms.md).
///
/// A reading has the joints of the virtual arm, which are not late, and that part of the real ones'
/// distance from where they should be by now which lasts, for half a second. Real arms that are
/// elsewhere altogether are a fault. A command to brake makes the virtual arm stand. Drives that
/// tell their torques are believed where they press harder than the wrist feels: the reading then
/// has their force. No heap in `read` and `apply`.
class PositionRobot final : public robot::Robot {
 public:
  /// What the arms are like; measured, once for each kind of arm.
  struct Options {
    double lag_s = 0.0;              ///< by which the joints follow; 0.2 s at most
    double max_off_rad = 30e-3;      ///< from where a joint should be by now
    double max_wrench_age_s = 5e-3;  ///< of the wrist sensor's sample; an older one tells nothing
    /// Force along the shaft which the drives may press with and the wrist not feel, beyond their
    /// friction.
    double max_unfelt_n = 20.0;
    /// Drives that tell no torques are driven all the same. Nothing but the wrist sensor then
    /// bounds what these arms press with: 233 N where it never says more than 10 N.
    bool bounded_by_wrist_alone = false;
  };

  /// `drives` must outlive it.
  PositionRobot(robot::PositionDrives& drives, const PerArm<robot::ArmModel>& models,
                const Options& options) noexcept;

  /// Fault::config, before anything moves, where the drives tell no torques and `Options` does not
  /// allow it.
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override {
    return fault_ != nullptr ? fault_ : drives_.fault();
  }

 private:
  static constexpr std::size_t ring_ticks = 401;
  struct Side {
    explicit Side(const robot::ArmModel& model) noexcept : arm(model) {}
    robot::VirtualArm arm;
    std::array<JointVector, ring_ticks> sent_rad = {};  ///< where it was to be, a ring
    JointVector off_rad;                                ///< what lasts of the difference
    Wrench wrench_in_tool;                              ///< newest
    double sample_time_s = 0.0;
    int far_ticks = 0;
    bool drives_believed = false;
  };
  /// Where the arm was to be so many milliseconds ago.
  [[nodiscard]] const JointVector& sent(const Side& side, std::size_t ago_ticks) const noexcept {
    return side.sent_rad[(next_ + ring_ticks - ago_ticks) % ring_ticks];
  }
  [[nodiscard]] bool follows(const Side& side, const JointVector& q_rad) const noexcept;
  void begin(const robot::RobotReading& reading) noexcept;
  void compare(Arm side, robot::ArmReading& reading) noexcept;
  void hear_drives(Arm side, robot::ArmReading& reading, const JointVector& driven_nm) noexcept;
  void stop_both() noexcept;

  robot::PositionDrives& drives_;
  Options options_;
  std::size_t lag_ticks_;
  PerArm<Side> sides_;
  std::size_t next_ = 0;  ///< in the rings
  bool started_ = false, answered_ = false;
  double time_s_ = 0.0, rail_m_ = 0.0;
  const char* fault_ = nullptr;
};

}  // namespace tuina::hardware
