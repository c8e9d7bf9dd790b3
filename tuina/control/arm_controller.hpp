// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "tuina/control/arm_sense.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/control/force_target.hpp"
#include "tuina/control/friction.hpp"
#include "tuina/control/joint_follower.hpp"
#include "tuina/control/skin_slope.hpp"
#include "tuina/control/tool_motion.hpp"

namespace tuina::control {

/// Set point of a contact: a point on the believed undeformed skin and its motion.
struct ContactTarget {
  Vector3 at_in_base = Vector3::Zero();
  Vector3 velocity_m_per_s = Vector3::Zero();
  Vector3 normal_in_base = Vector3::UnitZ();  ///< unit, out of the body
  double force_n = 0.0;
  /// Largest force of the virtual spring, whatever the sensor says: the force limit of the body
  /// zone.
  double max_spring_n = 90.0;
  ContactModel model;  ///< tissue prior or estimate
};

/// State of the controller. Commands change it; by itself it goes from `approach` to `contact` at
/// the first touch, and to `hold` when a command fails.
enum class Mode : std::uint8_t { hold, move, approach, contact, retract, lead };
/// Name of a mode, as messages and records have it.
[[nodiscard]] const char* name_of(Mode mode) noexcept;

/// Why a command failed. The arm then is in `hold`, but for `contact_lost` and `pushed_away`: there
/// the mode stays, the tool does not chase the skin, and the caller is to retract it.
enum class ContactFault : std::uint8_t {
  none,
  no_skin_found,
  contact_lost,
  pushed_away,
  blocked,
  bad_command
};
/// Name of a fault, as messages and records have it.
[[nodiscard]] const char* name_of(ContactFault contact_fault) noexcept;

/// Law by which an arm follows a contact path.
enum class ControlLaw : std::uint8_t {
  tuina,           ///< J^T impedance, virtual target, force trim
  virtual_target,  ///< as tuina, without the force trim
  thesis,          ///< [thesis] (3.5), target placed by the tissue model
  joint,           ///< [thesis] (3.9), target placed by the tissue model
};

/// What one arm does, as of its last step.
struct ArmStatus {
  Mode mode = Mode::hold;
  ContactFault contact_fault = ContactFault::none;
  bool settled = true;  ///< command finished: arrived and still, or in steady contact
  bool touching = false;
  double force_n = 0.0;  ///< measured, along the inward normal, friction of a sliding tool left out
  double set_force_n = 0.0;  ///< present set force of the force law
  double depth_m = 0.0;  ///< depth of the tip beneath the believed skin, along the inward normal
  double skin_error_m = 0.0;  ///< how much deeper than believed the skin was found
  Vector3 normal_in_base = Vector3::UnitZ();
  Vector3 virtual_target_in_base = Vector3::Zero();  ///< tool centre that the springs pull towards
  double stiffness_n_per_m = 0.0;                    ///< stiffness of the virtual spring
};

/// Controller of one arm, from state to joint torque. For each path a session calls `move_to` above
/// its start, `approach`, `track` in every tick, and `retract`. `step` runs at 1 kHz without heap,
/// exceptions or waiting; commands may be called between any two steps.
class ArmController {
 public:
  /// Gains and limits of the law; the defaults are those of docs/control.md.
  struct Options {
    ControlLaw law = ControlLaw::tuina;
    ForceTarget::Options force = {};
    ThesisImpedance thesis = {};
    double joint_stiffness_nm_per_rad = 400.0;
    double stiffness_n_per_m = 2000.0;  ///< in free motion, and along the skin
    double damping_ratio = 0.9;
    double max_pull_n = 25.0;  ///< limit of the spring in free motion
    double max_drag_n = 30.0;  ///< limit of the spring along the skin
    TurningGains turning = {};
    PostureGains posture = {};
    FrictionCompensation::Options friction = {};
    double learn_s = 3.0;  ///< friction identification after `start`; 0: none
    ToolMotion::Limits motion = {};
    double approach_m_per_s = 0.05;
    double search_m_per_s = 0.02;
    double search_from_m = 0.012;  ///< height above the believed skin where the search speed begins
    double search_to_m = 0.015;    ///< depth beneath the believed skin where the search ends
    double touch_n = 1.5;
    double touch_pull_n = 15.0;  ///< limit of the spring during approach
    double blocked_n = 15.0;     ///< contact force that stops a free motion
    double retract_m_per_s = 0.10;
    double lead_damping_nm_s_per_rad = 4.0;  ///< keeps a guided arm from coasting
  };

  /// At rest, in `hold`; the model must outlive it.
  ArmController(const robot::ArmModel& model, const Options& options) noexcept;

  /// Converts readings to a state; call once per tick, before `step`. Drives that obey later than
  /// the next command are damped less, and so are springs: a damper that acts late drives what it
  /// should damp. After the last late command this wears off by one tick of delay a second.
  [[nodiscard]] ArmState sense(const robot::ArmReading& reading, double time_s,
                               double rail_m) noexcept {
    soften(reading.command_age);
    return sense_.sense(reading, time_s, rail_m);
  }
  /// Starts in free air. The present configuration becomes the nullspace posture. Joint friction is
  /// identified first, within 30 mm of here; a `move_to` waits for it. A state that is no number
  /// starts nothing and is a bad command.
  void start(const ArmState& state) noexcept;

  /// Nullspace posture, which decides the elbow above all.
  void keep_posture(const JointVector& q_rad) noexcept;
  /// Comes to rest where it is, and stays.
  void hold() noexcept;
  /// Stops at once, for an arm that must not go on.
  void halt() noexcept;
  /// To be called after each tick in which another law has had the arm. A contact begins anew from
  /// the force that is felt; the clock of a free motion stands still, so that its reference does
  /// not run ahead.
  void resume_from_here() noexcept;
  /// Moves the tip to a pose in the air in a straight line, the shaft along the normal.
  void move_to(const ToolPose& tip) noexcept;
  /// Moves inward along the normal until contact, then keeps a light contact. Tares the wrist
  /// sensor first.
  void approach(const ToolPose& skin) noexcept;
  /// Updates the set point once per tick while in contact; ignored otherwise.
  void track(const ContactTarget& target) noexcept;
  /// Lead-through, [thesis] 3.2: gravity and most friction are compensated and the arm follows a
  /// hand. Any other command ends it.
  void lead() noexcept;
  /// Moves outward along the normal.
  void retract(double distance_m) noexcept;

  /// Joint torques, gravity included. `rail_m`: position of the linear base. A state that is no
  /// number, and a tick without length, change nothing: the last torques go on. Where that lasts,
  /// the guard takes the arm.
  [[nodiscard]] JointVector step(const ArmState& state, double rail_m, double dt_s) noexcept;

  /// As of the last step.
  [[nodiscard]] const ArmStatus& status() const noexcept { return status_; }
  /// Dynamics of the last step, for the guard.
  [[nodiscard]] const robot::ArmDynamics& dynamics() const noexcept { return dynamics_; }

 private:
  [[nodiscard]] JointVector next_torque(const ArmState& state, double dt_s) noexcept;
  [[nodiscard]] Vector3 free_force(const ArmState& state, double dt_s) noexcept;
  [[nodiscard]] Vector3 flight_force() noexcept;
  [[nodiscard]] Vector3 contact_force(double dt_s) noexcept;
  [[nodiscard]] double approach_force(double depth_m, double speed, double dt_s) noexcept;
  [[nodiscard]] JointVector baseline_torque(const ArmState& state, double dt_s) noexcept;
  [[nodiscard]] JointVector learning_torque(const ArmState& state, double dt_s) noexcept;
  void travel(const Vector3& centre, const Vector3& normal, const ToolMotion::Limits& limits,
              Mode mode) noexcept;
  void give_up(ContactFault contact_fault) noexcept;
  void soften(int command_age) noexcept;
  [[nodiscard]] bool escapes(double dt_s) noexcept;
  [[nodiscard]] bool flies() noexcept;
  void stop_learning() noexcept;

  const robot::ArmModel* model_;
  Options options_;
  Options given_;            // as for drives that obey at once
  double late_ticks_ = 0.0;  // how late the drives obey
  double gain_share_ = 1.0;  // of what is given
  ArmSense sense_;
  FrictionCompensation friction_;
  ForceTarget force_target_;
  Escape escape_;           // of a tool that leaves
  double leaving_n_ = 0.0;  // least force that was felt since it leaves
  double leaving_m_ = 0.0;  // distance that it shall go
  bool flies_ = false;      // since it has escaped, from there
  Vector3 escaped_at_in_base_ = Vector3::Zero();
  SkinSlope slope_;
  JointFollower follower_;
  ToolMotion motion_;
  double motion_s_ = 0.0;
  ContactTarget target_;
  ToolReference reference_;  // reference of the tool centre
  JointVector posture_rad_, here_rad_;
  robot::ArmDynamics dynamics_;
  Vector3 centre_ = Vector3::Zero();
  Vector3 velocity_ = Vector3::Zero();
  Vector3 spring_n_ = Vector3::Zero();  // spring force of the last step, without damping
  // Integral of the spring force at the goal of a free motion.
  Vector3 settling_n_ = Vector3::Zero();
  double search_m_ = 0.0, search_speed_ = 0.0;
  double quiet_s_ = 0.0, touched_s_ = 0.0, blocked_s_ = 0.0;
  double rail_m_ = 0.0;
  double learning_s_ = -1.0;  // time since identification began; negative: not running
  JointVector learn_rad_, learn_nm_;
  JointVector torque_nm_;  // of the last step
  std::optional<ToolPose> move_after_learning_;
  ArmStatus status_;
};

}  // namespace tuina::control
