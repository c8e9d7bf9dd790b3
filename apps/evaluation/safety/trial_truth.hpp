// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/evaluation/safety/trial.hpp"
#include "tuina/sim/robot/plant.hpp"

namespace tuina::app {

/// The plant of a trial as a robot, each of its milliseconds watched, those in which nobody runs
/// too: what only the simulation knows becomes the outcome.
class TrialTruth final : public robot::Robot {
 public:
  /// Both must outlive it.
  TrialTruth(const TrialPlan& plan, sim::Plant& plant)
      : plan_(plan),
        plant_(plant),
        models_(robot::both_models(robot::thesis_arm(), plan.site->mount)) {}

  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose&) override { return {}; }
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override { plant_.apply(command); }
  [[nodiscard]] const char* fault() const noexcept override { return plant_.fault(); }

  [[nodiscard]] double time_s() const noexcept { return plant_.truth().time_s; }
  [[nodiscard]] const TrialOutcome& outcome() const noexcept { return outcome_; }

  /// The first fault comes with the next millisecond; `set_n` is set or about to be.
  void begin(double set_n) noexcept;
  [[nodiscard]] bool begun() const noexcept { return onset_s_ >= 0.0; }
  [[nodiscard]] double onset_s() const noexcept { return onset_s_; }
  /// Whether the drives hear no guard any more. The trial's own guard runs on all the same; what it
  /// does then does not count, for a killed one would neither see nor do it.
  [[nodiscard]] bool guard_killed() const noexcept;
  /// What the session wants in this millisecond.
  void want(double set_n) noexcept { set_n_ = set_n; }
  /// Somebody does something about the fault.
  void note_action() noexcept;
  /// The arm will not go on; the first cause is kept.
  void note_stop(const std::string& cause, bool by_guard);
  [[nodiscard]] TrialOutcome finish();

 private:
  [[nodiscard]] const sim::ArmTruth& arm() const noexcept {
    return plant_.truth().arms[plan_.site->arm];
  }
  void look();
  void look_around();

  const TrialPlan& plan_;
  sim::Plant& plant_;
  PerArm<robot::ArmModel> models_;
  TrialOutcome outcome_;
  double onset_s_ = -1.0, set_n_ = 0.0;
  double acts_from_s_ = -1.0;                // where the first action counts from
  bool unfelt_ = false;                      // a person comes, and has not met the tool
  double min_force_n_ = 0.0;                 // true force meanwhile
  Vector3 from_in_couch_ = Vector3::Zero();  // where `further_m` counts from
  bool lost_skin_ = false;
  double squares_ = 0.0;
  int samples_ = 0;
};

}  // namespace tuina::app
