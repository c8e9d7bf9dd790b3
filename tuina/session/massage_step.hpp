// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tuina/control/arm_controller.hpp"
#include "tuina/control/beat_correction.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/motion/arm_job.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/robot_guard.hpp"
#include "tuina/session/base_path.hpp"
#include "tuina/session/controlled_arm.hpp"
#include "tuina/session/guarded_zone.hpp"
#include "tuina/session/live_command.hpp"
#include "tuina/session/playback.hpp"
#include "tuina/session/steering.hpp"

namespace tuina::session {

/// What one arm is doing; the order is that of one contact.
enum class ArmPhase : std::uint8_t { waiting, travel, approach, contact, retract, stopped };
/// Name of a phase, as pages and records have it.
[[nodiscard]] constexpr const char* name_of(ArmPhase phase) noexcept {
  constexpr const char* names[] = {"waiting", "travel",  "approach",
                                   "contact", "retract", "stopped"};
  return names[static_cast<std::size_t>(phase)];
}

/// One arm in one millisecond, for whoever records or draws.
struct ArmView {
  ArmPhase phase = ArmPhase::waiting;
  int path = -1;             ///< index into the plan; -1 while it serves none
  bool probing = false;      ///< its presses only feel a new place
  bool foretold = false;     ///< what was felt foretells a press as strong as the path's strongest
  double deepening_m = 0.0;  ///< by which that one is expected to bring the tool deeper
  double target_n = 0.0;     ///< force the technique asks for now; 0 outside of a contact
  double measured_n = 0.0;
  Vector3 tool_in_base = Vector3::Zero();  ///< tip of the tool
};

/// How one path of the plan went, in session time.
struct Performed {
  int path = 0;
  Arm arm = Arm::left;
  double begin_s = 0.0;  ///< first touch
  double end_s = 0.0;
  control::ContactFault contact_fault =
      control::ContactFault::none;     ///< reason why it was cut short, if it was
  bool whole = true;                   ///< true when every point of the path was served
  bool skipped = false;                ///< true when somebody asked to leave it
  std::optional<TissueEstimate> felt;  ///< tissue after the last press; only pressing feels it
  double nis = 1.0;                    ///< misfit of the tissue model; about 1 is good
  double stiffness_sd = 0.0;           ///< relative error of the stiffness at `reference_force_n`
};

/// The guard has stopped an arm.
struct Stop {
  double time_s = 0.0;
  Arm arm = Arm::left;
  safety::Cause cause = safety::Cause::none;
  int joint = -1;        ///< index of the joint off its planned start; -1: none
  double off_rad = 0.0;  ///< distance from the planned start
  double late_s = 0.0;   ///< how long the massage lasted and was not done; 0: that was not why
};
/// One line for people: the arm and the cause.
[[nodiscard]] Sentence explain(const Stop& stop);

/// Largest joint error at which a planned move may start; beyond it, the way was not checked for
/// collisions and the arm stays where it is.
inline constexpr double parked_within_rad = 0.35;

/// Limits of the wishes for more or less force together.
inline constexpr double min_intensity = 0.5, max_intensity = 1.4;

/// Where the person is believed to be, and what the session may do.
struct MassageOptions {
  Transform base_from_couch = Transform::Identity();  ///< pose that the session believes
  double rail_m = 0.0;
  double standoff_m = 40e-3;
  double force_ceiling_n = 45.0;
  double torso_n_per_m = 18e3;  ///< people have 10e3 to 35e3; this person's own is not known
  bool steer = true;            ///< the estimate is fed forward as soon as it has converged
  bool adaptive = true;         ///< presses follow the tissue that was felt
  bool cautious = true;         ///< rule A2 of the steering
  double intensity = 1.0;       ///< on every force, as it begins
  control::ArmController::Options controller = {};  ///< of both arms
  std::vector<KnownPlace> known = {};               ///< places that an earlier session has felt
  double max_shift_m =
      10e-3;  ///< largest shift of the skin since the scan; beyond it a new scan is needed
};

/// The massage itself, one millisecond at a time: travel, approach, contact, retract, for both
/// arms, one step of the plan after the other. What it knows of the world comes in with the
/// readings; what goes out is a proposal, of which a guard decides. Memory is taken in the
/// constructor; `propose` and `heed` are real-time.
class MassageStep {
 public:
  /// Takes all the memory that it needs; `jobs` are the paths of each arm, in their order.
  MassageStep(const massage::Plan& plan, PerArm<std::vector<motion::ArmJob>> jobs,
              const PerArm<robot::ArmModel>& models, const MassageOptions& options);

  /// What both arms should do in this millisecond.
  [[nodiscard]] safety::RobotProposal propose(const robot::RobotReading& reading) noexcept;
  /// What the guard made of it; call it after each `propose`.
  void heed(const safety::RobotVerdict& verdict) noexcept;

  /// Takes effect in the next step, and shows within 100 ms. Call it between two steps.
  void obey(LiveCommand command) noexcept;

  /// True when every job is done, or after a stop when the arms have let go.
  [[nodiscard]] bool finished() const noexcept { return finished_; }
  /// What each arm does now.
  [[nodiscard]] const PerArm<ArmView>& view() const noexcept { return view_; }
  /// Contacts that are over, in their order.
  [[nodiscard]] const std::vector<Performed>& performed() const noexcept { return performed_; }
  /// Stops of the guard, in their order.
  [[nodiscard]] const std::vector<Stop>& stops() const noexcept { return stops_; }
  /// What the steering has changed, in its order.
  [[nodiscard]] const std::vector<Decision>& decisions() const noexcept {
    return steering_.decisions();
  }
  /// The person lies elsewhere than scanned: the arms let go, fly to where they started, and a new
  /// scan is needed. After a stop nothing is.
  [[nodiscard]] bool wants_scan() const noexcept { return moved_ && stopped_s_ < 0.0; }
  /// Somebody has asked to pause, and not to go on yet.
  [[nodiscard]] bool paused() const noexcept { return paused_; }
  /// Factor on every force by the wishes so far.
  [[nodiscard]] double intensity() const noexcept { return intensity_; }
  /// How far the skin was found from the scan, from the contacts so far.
  [[nodiscard]] const Vector3& shift_in_base() const noexcept { return shift_in_base_; }

 private:
  struct Side {
    Side(const robot::ArmModel& model, const control::ArmController::Options& controller)
        : controlled(model, controller) {}
    ControlledArm controlled;
    control::ArmController& controller() noexcept { return controlled.controller; }
    [[nodiscard]] const control::ArmController& controller() const noexcept {
      return controlled.controller;
    }
    std::vector<motion::ArmJob> jobs = {};
    std::size_t job = 0;
    std::size_t waypoint = 0;
    double leg_s = 0.0;     ///< start of the present leg of the free path
    double amiss_s = -1.0;  ///< time since which it has stood off its planned start; -1: it has not
    ArmPhase phase = ArmPhase::waiting;
    double contact_s = 0.0;
    double probed_s = 0.0;    ///< of this contact, pauses aside
    bool registered = false;  ///< where the tool found the skin is taken into account
    Playback playback = {};
    control::BeatCorrection beats = {};
    bool skip = false, again = false, cut_short = false;
    bool frozen = false;  ///< the guard holds the arm for a moment
    std::array<control::ToolPose, 3> detour =
        {};  ///< waypoints back to where the next free path begins, or home
    int detour_at = -1, detour_legs = 0;
    control::ContactFault contact_fault = control::ContactFault::none;
    TangentTissue expected = {};  ///< tissue that is fed forward
    bool foreknown = false;       ///< that is the tissue of an earlier session
    BasePoint wanted = {};        ///< the place of the path where the tool should be now
    double commanded_n = 0.0;     ///< `wanted.force_n`, corrected by the taps before
    JointVector q_rad = {};       ///< joint angles of this millisecond
    control::ToolPose home = {};  ///< tool pose in which the session began
    JointVector home_rad = {};
  };

  void conduct(Arm arm, double time_s) noexcept;
  [[nodiscard]] bool stands_as_planned(Side& side, Arm arm, double time_s) noexcept;
  void begin_approach(Side& side, Arm arm, double time_s) noexcept;
  void begin_contact(Side& side, Arm arm, double time_s) noexcept;
  void press_on(Side& side, Arm arm, double time_s) noexcept;
  [[nodiscard]] bool above_path(const Side& side) const noexcept;
  [[nodiscard]] bool on_its_way(const Side& side) const noexcept;
  void end_travel(Side& side, Arm arm, double time_s) noexcept;
  void end_retract(Side& side, double time_s) noexcept;
  void next_job(Side& side) noexcept;
  void register_skin(Side& side, double time_s) noexcept;
  void end_contact(Side& side, Arm arm, double time_s) noexcept;
  /// Compliance of the gears along the normal, as the tool shows it, m/N: encoders at the motors
  /// report the tool deeper than it is by this much for each newton.
  [[nodiscard]] double gears_m_per_n(Arm arm) const noexcept;
  void feel(Side& side, Arm arm, double time_s, const ArmState& state) noexcept;
  void let_go(double time_s) noexcept;
  void leave(double time_s) noexcept;
  void detour(Side& side, const control::ToolPose& goal, bool from_above, double time_s) noexcept;
  void fly_home(Side& side, double time_s) noexcept;
  void heed(Arm arm, const safety::Verdict& verdict) noexcept;
  [[nodiscard]] const motion::ArmJob* job_of(const Side& side) const noexcept;
  [[nodiscard]] const massage::PlannedPath* path_of(const Side& side) const noexcept;
  [[nodiscard]] const BasePath& base_path_of(const Side& side) const noexcept;
  [[nodiscard]] safety::Proposal proposal(const Side& side,
                                          const JointVector& torque_nm) const noexcept;

  massage::Plan plan_;
  std::vector<BasePath> paths_in_base_;  // of the plan, in its order
  PerArm<robot::ArmModel> models_;
  MassageOptions options_;
  PerArm<Side> sides_;
  Steering steering_;
  PerArm<ArmView> view_;
  int step_ = 0;
  double intensity_;
  bool paused_ = false, stop_asked_ = false;
  bool moved_ = false;  ///< the person, since the scan
  Vector3 shift_in_base_ = Vector3::Zero(), next_shift_in_base_ = Vector3::Zero();
  double time_s_ = 0.0;  ///< of the last reading
  bool started_ = false;
  bool finished_ = false;
  double stopped_s_ = -1.0;
  double startled_s_ = -1e9;  ///< time at which a contact last ended by itself, as by a cough
  double tool_radius_m_ = 0.0;
  std::vector<Performed> performed_;
  std::vector<Stop> stops_;
};

}  // namespace tuina::session
