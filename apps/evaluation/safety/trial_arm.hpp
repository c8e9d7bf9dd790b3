// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/evaluation/safety/fault_table.hpp"
#include "apps/evaluation/safety/site.hpp"
#include "tuina/session/guarded_arm.hpp"

namespace tuina::app {

/// The arm of a trial with its controller and its guard, and the other arm, which is parked. It is
/// the only place that knows how a session guards an arm; a controller goes mad between the two.
class TrialArm {
 public:
  /// `site` must outlive it.
  explicit TrialArm(const Site& site);

  void sense(const robot::RobotReading& reading) noexcept;
  /// Torques of both arms that the guards allow; `set_n` is what the session wants now.
  [[nodiscard]] robot::RobotCommand command(const robot::RobotReading& reading, Stage stage,
                                            double set_n, double rail_m) noexcept;
  /// From the next command on.
  void go_mad(Madness madness, double size_n, double hz) noexcept;

  [[nodiscard]] control::ArmController& controller() noexcept {
    return guarded_[site_.arm].controller;
  }
  [[nodiscard]] const safety::Verdict& verdict() const noexcept {
    return guarded_[site_.arm].verdict;
  }
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  /// Force into the body that the torques of the last command hold.
  [[nodiscard]] double inward_n() const noexcept { return inward_n_; }

 private:
  [[nodiscard]] safety::Proposal proposal(Stage stage, double set_n,
                                          const JointVector& torque_nm) const noexcept;
  void spoil(safety::Proposal& proposal) noexcept;

  const Site& site_;
  PerArm<robot::ArmModel> models_;
  PerArm<session::GuardedArm> guarded_;
  Madness madness_ = Madness::none;
  double size_n_ = 0.0, hz_ = 0.0, mad_s_ = 0.0;
  safety::Proposal last_;
  bool stopped_ = false;
  double inward_n_ = 0.0;
};

}  // namespace tuina::app
