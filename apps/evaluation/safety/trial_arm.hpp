// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/evaluation/safety/fault_table.hpp"
#include "apps/evaluation/safety/site.hpp"
#include "tuina/safety/robot_guard.hpp"
#include "tuina/session/controlled_arm.hpp"

namespace tuina::app {

/// The arm of a trial with its controller and its guard, and the other arm, which is parked. It is
/// the only place that knows how a session guards an arm; a controller goes mad between the two.
class TrialArm {
 public:
  /// `site` must outlive it.
  explicit TrialArm(const Site& site);

  void sense(const robot::RobotReading& reading) noexcept;
  /// What the controllers of both arms want; `set_n` is what the session wants now.
  [[nodiscard]] safety::RobotProposal propose(const robot::RobotReading& reading, Stage stage,
                                              double set_n) noexcept;
  /// What the guard made of it.
  void heed(const safety::RobotVerdict& verdict, Stage stage) noexcept;
  /// From the next command on.
  void go_mad(Madness madness, double size, double hz, int joint) noexcept;
  /// Both arms of it, for what goes on in the room.
  [[nodiscard]] control::ArmController& controller(Arm arm) noexcept {
    return controlled_[arm].controller;
  }

  [[nodiscard]] control::ArmController& controller() noexcept {
    return controlled_[site_.arm].controller;
  }
  [[nodiscard]] safety::RobotGuard& guard() noexcept { return guard_; }
  [[nodiscard]] const safety::Verdict& verdict() const noexcept { return verdicts_[site_.arm]; }
  [[nodiscard]] const safety::Verdict& verdict(Arm arm) const noexcept { return verdicts_[arm]; }
  /// The guard holds the tool where it is, for a moment.
  [[nodiscard]] bool frozen() const noexcept { return verdict().action == safety::Action::freeze; }
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  /// Force into the body that the torques of the last command hold.
  [[nodiscard]] double inward_n() const noexcept { return inward_n_; }

 private:
  [[nodiscard]] safety::Proposal proposal(Stage stage, double set_n,
                                          const JointVector& torque_nm) const noexcept;
  void spoil(safety::Proposal& proposal) noexcept;

  const Site& site_;
  PerArm<robot::ArmModel> models_;
  PerArm<session::ControlledArm> controlled_;
  safety::RobotGuard guard_;
  PerArm<safety::Verdict> verdicts_;
  Madness madness_ = Madness::none;
  double size_ = 0.0, hz_ = 0.0, mad_s_ = 0.0;
  int joint_ = 0;
  safety::Proposal last_;
  bool stopped_ = false;
  double inward_n_ = 0.0;
};

}  // namespace tuina::app
