// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "tuina/control/arm_sense.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/control/force_target.hpp"
#include "tuina/control/friction.hpp"
#include "tuina/control/joint_follower.hpp"
#include "tuina/control/tool_motion.hpp"

namespace tuina::control {

/// Where the tool should press now: a place on the undeformed skin as believed, and how it moves
/// there.
struct ContactTarget {
  Vector3 at_in_base = Vector3::Zero();
  Vector3 velocity_m_per_s = Vector3::Zero();
  Vector3 normal_in_base = Vector3::UnitZ();  ///< unit, out of the body
  double force_n = 0.0;
  /// The leash: never more force than this from the springs, whatever the sensor says; the zone's
  /// trip.
  double max_spring_n = 90.0;
  ContactModel model;  ///< prior or estimate
};

/// What an arm does. Commands change it; the controller itself goes from approach to contact and
/// back.
enum class Doing : std::uint8_t { hold, move, approach, contact, retract, lead };
[[nodiscard]] const char* name_of(Doing doing) noexcept;

/// Why a command could not be done; the arm then holds where it is.
enum class Trouble : std::uint8_t {
  none,
  no_skin_found,
  contact_lost,
  pushed_away,
  blocked,
  bad_command
};
[[nodiscard]] const char* name_of(Trouble trouble) noexcept;

enum class Law : std::uint8_t {
  tuina,           ///< J^T impedance, virtual target, force trim
  virtual_target,  ///< the same without the trim
  thesis,          ///< [thesis] (3.5), target placed by the model
  joint,           ///< [thesis] (3.9), target placed by the model
};

struct ArmStatus {
  Doing doing = Doing::hold;
  Trouble trouble = Trouble::none;
  bool settled = true;  ///< the command is done: arrived and still, or in contact and quiet
  bool touching = false;
  double force_n = 0.0;       ///< measured along the inward normal
  double set_force_n = 0.0;   ///< what the force law holds at present
  double depth_m = 0.0;       ///< of the tool beneath the believed skin, along the inward normal
  double skin_error_m = 0.0;  ///< how much deeper than believed the skin was found
  Vector3 normal_in_base = Vector3::UnitZ();
  Vector3 virtual_target_in_base =
      Vector3::Zero();             ///< of the tool's centre: where the springs pull it
  double stiffness_n_per_m = 0.0;  ///< of those springs
};

/// One arm from state to torque. A session, for each path: `move_to` above its start, `approach`,
/// then `track` in every tick, `retract`. `step` runs at 1 kHz: no heap, no exceptions, no waiting;
/// commands may be called between two steps, at any time.
class ArmController {
 public:
  struct Options {
    Law law = Law::tuina;
    ForceTarget::Options force = {};
    ThesisImpedance thesis = {};
    double joint_stiffness_nm_per_rad = 400.0;
    double stiffness_n_per_m = 2000.0;  ///< in free motion, and along the skin
    double damping_ratio = 0.9;
    double max_pull_n = 25.0;  ///< of the springs in free motion
    double max_drag_n = 30.0;  ///< of the springs along the skin
    TurningGains turning = {};
    PostureGains posture = {};
    FrictionCompensation::Options friction = {};
    double learn_s =
        3.0;  ///< after `start` every joint is moved to and fro to learn its friction; 0: not
    ToolMotion::Limits motion = {};
    double approach_m_per_s = 0.05;
    double search_m_per_s = 0.02;
    double search_from_m = 0.012;  ///< above the believed skin
    double search_to_m = 0.015;    ///< beneath it
    double touch_n = 1.5;
    double touch_pull_n = 15.0;  ///< of the spring during approach
    double blocked_n = 15.0;     ///< on a tool that should be in the air
    double retract_m_per_s = 0.10;
    double lead_damping_nm_s_per_rad = 4.0;  ///< so that a led arm does not coast
  };

  ArmController(const robot::ArmModel& model, const Options& options) noexcept;

  /// Readings to state; call once per tick, before `step`.
  [[nodiscard]] ArmState sense(const robot::ArmReading& reading, double time_s,
                               double rail_m) noexcept {
    return sense_.sense(reading, time_s, rail_m);
  }
  /// Where the arm is, in free air; its posture becomes the one it keeps to where the task leaves
  /// it free. It learns its joint friction first, within 30 mm of there; a `move_to` waits for
  /// that.
  void start(const ArmState& state) noexcept;

  /// The joint angles the arm keeps to where the task leaves it free, its elbow above all.
  void keep_posture(const JointVector& q_rad) noexcept;
  void hold() noexcept;
  /// As `hold`, at once: for an arm that must not go on.
  void halt() noexcept;
  /// The tool's foremost point to a place in the air, its shaft along the normal, in a straight
  /// line.
  void move_to(const ToolPose& foremost) noexcept;
  /// Down along the normal until the skin is felt, then a light contact is kept. Tares the wrist
  /// sensor first.
  void approach(const ToolPose& skin) noexcept;
  /// In contact, once per tick. Before the skin was felt, and after contact, it does nothing.
  void track(const ContactTarget& target) noexcept;
  /// Lead-through, [thesis] 3.2: the arm carries its weight and most of its friction and gives way
  /// to a hand, to be taught by it. Any other command ends it.
  void lead() noexcept;
  /// Outward along the normal.
  void retract(double distance_m) noexcept;

  /// Torques at the joints, gravity included. `rail_m` is where the linear base is.
  [[nodiscard]] JointVector step(const ArmState& state, double rail_m, double dt_s) noexcept;

  [[nodiscard]] const ArmStatus& status() const noexcept { return status_; }
  /// Of the last step, for the guard.
  [[nodiscard]] const robot::ArmDynamics& dynamics() const noexcept { return dynamics_; }

 private:
  [[nodiscard]] Vector3 free_force(const ArmState& state, double dt_s) noexcept;
  [[nodiscard]] Vector3 contact_force(double dt_s) noexcept;
  [[nodiscard]] double approach_force(double depth_m, double speed, double dt_s) noexcept;
  [[nodiscard]] JointVector baseline_torque(const ArmState& state, double dt_s) noexcept;
  [[nodiscard]] JointVector learning_torque(const ArmState& state, double dt_s) noexcept;
  void travel(const Vector3& centre, const Vector3& normal, const ToolMotion::Limits& limits,
              Doing doing) noexcept;
  void give_up(Trouble trouble) noexcept;
  void stop_learning() noexcept;

  const robot::ArmModel* model_;
  Options options_;
  ArmSense sense_;
  FrictionCompensation friction_;
  ForceTarget force_target_;
  JointFollower follower_;
  ToolMotion motion_;
  double motion_s_ = 0.0;
  ContactTarget target_;
  ToolReference reference_;  // of the tool's centre
  JointVector posture_rad_, here_rad_;
  robot::ArmDynamics dynamics_;
  Vector3 centre_ = Vector3::Zero();
  Vector3 velocity_ = Vector3::Zero();
  Vector3 spring_n_ = Vector3::Zero();    // of the last step, without damping
  Vector3 settling_n_ = Vector3::Zero();  // integral of the spring at the goal of a free motion
  double search_m_ = 0.0, search_speed_ = 0.0;
  double quiet_s_ = 0.0, touched_s_ = 0.0, blocked_s_ = 0.0;
  double rail_m_ = 0.0;
  double learning_s_ = -1.0;  // since it began, negative when it does not learn
  JointVector learn_rad_, learn_nm_;
  std::optional<ToolPose> move_after_learning_;
  ArmStatus status_;
};

}  // namespace tuina::control
