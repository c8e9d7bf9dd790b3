// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/observer.hpp"
#include "tuina/telemetry/mcap/ros_diagnostics.hpp"

namespace tuina::record {

// Both are of event_fields.hpp, which needs a JSON library that users of this header need not have.
struct TissueEvent;
struct DecisionEvent;

/// How scanner, guards, arms and wrist sensors are, what was felt and decided last, and whether the
/// session was stopped, as monitors of ROS 2 show it. A message is due each second, and at once
/// when a part gets worse than it was told, tissue was felt, the steering decided, or an arm
/// stopped.
class SessionDiagnostics {
 public:
  /// What the robot is called.
  explicit SessionDiagnostics(const std::string& robot_name);

  /// @{
  /// The back was scanned; the robot stands so at the couch.
  void note_scan(const scanner::Scan& scan);
  void note_place(const robot::RobotPlacement& placement);
  /// @}
  /// @{
  /// What the presses of a path have felt, and what the steering has decided.
  void note_tissue(const TissueEvent& felt);
  void note_decision(const DecisionEvent& made);
  /// @}

  /// The message that is due with this millisecond, null where none is. Lives until the next call.
  /// Called once the robot has its place.
  const telemetry::ros::DiagnosticArray* look(const session::Tick& tick, std::uint64_t missing_ms);

 private:
  using Status = telemetry::ros::DiagnosticStatus;
  struct Side {
    safety::Verdict worst;               ///< since the message before
    int clamped_ms = 0;                  ///< likewise
    double age_s = 0.0;                  ///< oldest sample of the wrist sensor, likewise
    Vector3 air_n = Vector3::Zero();     ///< felt in the air, low-passed, in the tool
    std::optional<Vector3> first_air_n;  ///< the same at the beginning, once it is known
    int air_samples = 0;
  };
  void feel(const session::Tick& tick, Arm arm);
  [[nodiscard]] bool got_worse(Arm arm) const;
  void tell_arm(const session::Tick& tick, Arm arm);
  void tell_session(const session::Tick& tick, std::uint64_t missing_ms);

  double tool_mass_kg_ = 0.0;
  std::unique_ptr<const PerArm<robot::ArmModel>> models_;
  PerArm<Side> sides_;
  telemetry::ros::DiagnosticArray told_;
  double told_s_ = 0.0;
  std::uint64_t ticks_ = 0, missing_ms_ = 0;
  bool news_ = true;  ///< not told yet
  std::size_t stops_ = 0;
  std::string stopped_by_;
};

}  // namespace tuina::record
