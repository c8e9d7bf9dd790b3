// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/core/result.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::robot {

/// Where position-controlled arms shall be in this millisecond.
struct PlaceCommand {
  PerArm<JointVector> q_rad;
  double rail_m = 0.0;
};

/// The interface to two arms that take places and no torques, simulated or real: what the maker's
/// controller of a UR or an xArm is to its user. `read`, `follow` and `fault` neither allocate nor
/// throw.
///
/// Such arms stand where they were sent last when nobody tells them more, pressed or not.
class PositionDrives {
 public:
  virtual ~PositionDrives() = default;
  /// As `Robot::stand_ready`.
  [[nodiscard]] virtual Result<void> stand_ready(const ReadyPose& pose) = 0;
  /// Waits for the next millisecond. Joints are those of the newest cycle of the arms, some
  /// milliseconds old at most; the wrist sensor has a new sample every millisecond or two.
  [[nodiscard]] virtual std::optional<RobotReading> read() noexcept = 0;
  /// Torques of the drives at their joints with the reading that came last, Nm, as their currents
  /// tell; null, from the beginning, where nobody tells them.
  [[nodiscard]] virtual const PerArm<JointVector>* driven_nm() const noexcept { return nullptr; }
  /// The newest place; the arms take what is there when their own cycle begins.
  virtual void follow(const PlaceCommand& command) noexcept = 0;
  /// As `Robot::fault`.
  [[nodiscard]] virtual const char* fault() const noexcept = 0;

 protected:
  PositionDrives() = default;
  PositionDrives(const PositionDrives&) = default;
  PositionDrives& operator=(const PositionDrives&) = default;
};

}  // namespace tuina::robot
