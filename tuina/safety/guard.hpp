// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "tuina/core/arm.hpp"
#include "tuina/safety/guard_states.hpp"
#include "tuina/safety/limits.hpp"
#include "tuina/safety/motor_trial.hpp"
#include "tuina/safety/zone_field.hpp"

namespace tuina::safety {

/// Why a guard does not let a proposal through as it is.
enum class Cause : std::uint8_t {
  none,
  torque_clamped,
  torque_rate_clamped,
  late_tick,
  force_spike,
  force_stale,
  encoder_jump,
  joint_too_fast,
  tool_too_fast,
  torque_saturated,
  pushed_out,
  bad_proposal,
  torque_not_finite,
  leash_too_long,
  force_spikes,
  force_rising,
  force_over_cap,
  force_over_trip,
  set_force_too_high,
  state_not_finite,
  arms_too_close,          ///< found by who knows both arms, not by the guard of one
  surroundings_too_close,  ///< the chair, the bed, or the robot's own body; likewise
  asked_to,                ///< somebody asked to stop
  person_moved,            ///< the skin is not where it was scanned
  not_as_planned,  ///< an arm about to leave its parking place does not stand in its posture
  clock,           ///< the robot's clock does not go with its ticks
  force_stuck,     ///< the wrist sensor repeats itself while the tool moves
  force_off_zero,  ///< the wrist sensor is off its zero, or the tool is not that of the table
  force_reversed,  ///< what is felt and the way out of the body point apart
  inward_force,    ///< the torques would press harder than the zone bears
  not_obeyed,      ///< the arm does not do what the guard's own law tells it
  torques_amiss,   ///< the joints do not move as their torques and the wrist sensor say
  drive_amiss,     ///< a drive measures another torque than it is told, or its joint alone does not
                   ///< move as its torque says
  rail_moved,
  lease_over,    ///< operator or hand stop do not show any more that they are there
  no_proposal,   ///< the controller is silent
  guard_silent,  ///< found by the controller
};
/// In words for people, as reports and records have it.
[[nodiscard]] const char* name_of(Cause cause) noexcept;

/// What the raw sensors of one arm and the guard's own model of it say in one millisecond.
struct Observation {
  std::uint64_t tick = 0;
  double time_s = 0.0;
  double wrench_time_s = 0.0;
  JointVector q_rad;
  JointVector dq_rad_per_s;
  Vector3 force_in_base_n =
      Vector3::Zero();  ///< of the environment ON the tool, its weight taken off
  Vector3 tool_in_base = Vector3::Zero();
  Vector3 tip_in_base = Vector3::Zero();  ///< where the tool touches first
  Vector3 tool_velocity_m_per_s = Vector3::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, max_joints> jacobian;  ///< of the tool's position
  JointMatrix mass_kg_m2;                                               ///< rotors included
  JointVector gravity_nm;
  /// Momentum that neither torque, wrist nor friction explains, as a share of what a sound arm
  /// leaves.
  double torque_misfit = 0.0;
  int weak_joint = -1;  ///< whose drive alone would explain it; -1: none
  /// The torque of each joint that was told or felt in the last millisecond and does not show in
  /// the motion; empty where it is not known.
  JointVector unexplained_nm;
  /// What drives measure of their torques and were not told, as a share of what is borne; 0 where
  /// they measure none.
  double drive_misfit = 0.0;
  int reversed_joint = -1;  ///< whose drive, not believed then, turns the other way; -1: none
  /// Change of what the wrist sensor says of nothing but the tool, beyond what sensors drift by.
  double zero_jump_n = 0.0;
  int wrist_repeats = 0;       ///< samples in a row equal to the one before, to the last bit
  bool wrist_stepped = false;  ///< it has changed as no body can change it
  const ZoneField::Cell* skin = nullptr;  ///< under the tool, where the guard knows the person
};

/// What somebody wants the arm to do next.
struct Proposal {
  JointVector torque_nm;
  Phase phase = Phase::free;
  Zone zone = Zone::denied;
  double set_force_n = 0.0;
  Vector3 normal_in_base = Vector3::UnitZ();         ///< unit, out of the body
  Vector3 virtual_target_in_base = Vector3::Zero();  ///< where the springs pull the tool to
  double stiffness_n_per_m = 0.0;
  std::uint32_t age_ticks = 0;  ///< milliseconds since the controller last said anything
};

/// What an arm may do in this millisecond, and why not more.
struct Verdict {
  JointVector allowed_nm;
  Action action = Action::pass;  ///< at `brake` the drives' brakes are to hold the joints
  Cause cause = Cause::none;
  bool latched = false;  ///< a stop: lasts as long as this guard
};

/// True for a unit vector; false for one that is not finite, too.
[[nodiscard]] bool is_unit(const Vector3& normal) noexcept;

/// The gate between a controller it does not know and one arm. It judges each millisecond by
/// itself, takes the arm over with a small law of its own when it must, and never lets out a torque
/// that is not finite, too large or too sudden. What it has latched ends with it: who goes on after
/// a stop begins with a new guard. Real-time: no heap, no exceptions.
class Guard {
 public:
  /// The arm and the limits it is guarded by.
  struct Options {
    JointVector torque_limit_nm;  ///< of the drives; one per joint, 0 where it is no number
    JointVector min_rad = {}, max_rad = {};  ///< ends of the joints; empty: not known
    std::array<ForceLimits, zones> force = force_ceilings;
    Ceilings limits = {};
    double period_s = control_period_s;
    bool bench = false;  ///< a patch of tissue in a laboratory, no person: Zone::bench may be told
  };

  /// Every option above its compiled ceiling counts as the ceiling. A lower set force lowers the
  /// trip with it.
  explicit Guard(const Options& options) noexcept;

  /// Judges one millisecond; must be called in each.
  [[nodiscard]] Verdict check(const Observation& seen, const Proposal& proposal) noexcept;

  /// A stop that others than this guard found the reason for; it shows in the next `check`.
  void stop(Action action, Cause cause) noexcept {
    if (!is_stop(state_)) stopped_by_ = cause;
    state_ = next_state(state_, action, true);
  }

  /// Median of the last three forces on the tool.
  [[nodiscard]] double felt_n() const noexcept { return medians_n_.back(); }
  /// True while a living sensor feels a body under the tool.
  [[nodiscard]] bool pressed() const noexcept;
  /// As they count: no option above its compiled ceiling.
  [[nodiscard]] const Options& options() const noexcept { return options_; }

 private:
  /// The strongest action that the checks of one millisecond ask for, and what asked first.
  struct Finding {
    Action action = Action::pass;
    Cause cause = Cause::none;
    void add(Action a, Cause c) noexcept {
      if (a > action) action = a, cause = c;
    }
  };

  void begin(const Observation& seen) noexcept;
  void judge_time(const Observation& seen, Finding& finding) noexcept;
  void judge_joints(const Observation& seen, Finding& finding) noexcept;
  void judge_sensor(const Observation& seen, Finding& finding) noexcept;
  void take_sample(const Observation& seen, Finding& finding) noexcept;
  void judge_force(const Observation& seen, const Proposal& proposal, Finding& finding) noexcept;
  void judge_motion(const Observation& seen, const Proposal& proposal, Finding& finding) noexcept;
  void judge_proposal(const Observation& seen, const Proposal& proposal, Finding& finding) noexcept;
  void judge_obedience(const Observation& seen, Finding& finding) noexcept;
  [[nodiscard]] bool torque_fits(const Proposal& proposal) const noexcept;
  void judge_torques(const Observation& seen, const Proposal& proposal, Finding& finding) noexcept;
  void judge_drives(const Observation& seen, Finding& finding) noexcept;
  [[nodiscard]] std::uint32_t silent_ticks(const Observation& seen,
                                           const Proposal& proposal) noexcept;
  [[nodiscard]] ForceLimits limits_of(const Observation& seen,
                                      const Proposal& proposal) const noexcept;
  [[nodiscard]] double inward_cap_n(const Observation& seen,
                                    const Proposal& proposal) const noexcept;
  void find_way_out(const Observation& seen, const Proposal& proposal) noexcept;
  [[nodiscard]] bool above_where_it_left(const Observation& seen) const noexcept;
  [[nodiscard]] double inward_n(const Observation& seen,
                                const JointVector& torque_nm) const noexcept;
  [[nodiscard]] bool feels() const noexcept;
  [[nodiscard]] bool in_air() const noexcept;
  void judge_unknown(Finding& finding) noexcept;
  [[nodiscard]] JointVector blind_torque(Action action) const noexcept;
  /// True while a tool whose joints are in doubt is pushed off the skin.
  [[nodiscard]] bool leaves_in_doubt() const noexcept;
  [[nodiscard]] JointVector torque_in_doubt(const JointVector& dq_rad_per_s) const noexcept;
  /// True when a person comes after a tool that leaves; each tick once.
  [[nodiscard]] bool followed(const Vector3& tool_in_base) noexcept;
  [[nodiscard]] JointVector off_ends_nm(const JointVector& q_rad) const noexcept;
  [[nodiscard]] JointVector own_torque(const Observation& seen, Action action) noexcept;
  [[nodiscard]] JointVector let_through(const Observation& seen, const Proposal& proposal,
                                        Finding& finding) const noexcept;
  [[nodiscard]] JointVector limited(const JointVector& torque_nm, double rate_nm_per_s,
                                    Finding& finding) const noexcept;
  [[nodiscard]] bool pushes_outward(const Observation& seen,
                                    const JointVector& torque_nm) const noexcept;

  Options options_;
  bool started_ = false;
  std::uint64_t tick_ = 0,
                ticks_ = 1;  ///< the last one, and how many have gone by since the one before
  double time_s_ = 0.0;
  JointVector q_rad_, dq_rad_per_s_, drift_rad_;
  JointVector gravity_nm_, levers_m_;  ///< the last that were believed; for a force outward
  JointVector allowed_nm_;
  Vector3 normal_in_base_ = Vector3::UnitZ();
  Vector3 left_at_in_base_ = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());

  // Force: the last samples taken as true, their medians, and the spikes among them.
  double sample_time_s_ = 0.0, sample_age_s_ = 0.0;
  Vector3 sample_in_base_n_ = Vector3::Zero();
  int samples_ = 0;
  std::array<double, 3> samples_n_ = {};
  std::array<double, 6> medians_n_ = {};
  double believed_n_ = 0.0;  ///< the last median of a sensor that was living and believed
  int suspects_ = 0;
  std::array<int, 5> spike_ages_ = {};

  // Checks that need several milliseconds count them here.
  int clock_ = 0, repeated_ = 0, too_fast_ = 0, swinging_ = 0, over_cap_ = 0, saturated_ = 0,
      not_finite_ = 0, pushed_out_ = 0, rising_ = 0, reversed_ = 0, inward_ = 0, not_obeyed_ = 0,
      frozen_ = 0, blind_ = 0, unknown_ = 0, drive_amiss_ = 0;
  double pushed_out_m_ = 0.0;
  bool fled_ = false;   ///< the tool was pressed in its present motion outward
  bool flies_ = false;  ///< it is leaving since, within the limits of a flight
  std::uint32_t same_ = 0;
  bool encoders_doubted_ = false, pressed_at_doubt_ = false, force_doubted_ = false;
  JointVector told_nm_;  ///< the last proposal
  MotorTrial motor_trial_;

  GuardState state_ = GuardState::working;
  Cause stopped_by_ = Cause::none;
  Action taken_over_ = Action::pass;
  Vector3 hold_in_base_ = Vector3::Zero();
  JointVector hold_rad_, from_rad_;  // where it is held, and was when it was taken over
  Vector3 taken_over_in_base_ = Vector3::Zero();
  Vector3 last_pressed_in_base_ = Vector3::Zero();  // or taken over, where it was not pressed since
  Vector3 met_in_base_ = Vector3::Zero();           // likewise, by a contact longer than a swing
  int pressed_ticks_ = 0;
  double held_n_ = 0.0;      ///< felt when it took over
  double min_felt_n_ = 0.0;  ///< least that was felt since the tool leaves
};

}  // namespace tuina::safety
