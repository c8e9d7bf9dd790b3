// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tuina/control/arm_controller.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/motion/arm_job.hpp"
#include "tuina/motion/arm_separation.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/safety/guard.hpp"
#include "tuina/session/guarded_zone.hpp"
#include "tuina/session/live_command.hpp"
#include "tuina/session/playback.hpp"
#include "tuina/session/steering.hpp"

namespace tuina::session {

/// What one arm is doing; the order is that of one contact.
enum class ArmPhase : std::uint8_t { waiting, travel, approach, contact, retract, stopped };

/// One arm in one millisecond, for whoever records or draws.
struct ArmView {
  ArmPhase phase = ArmPhase::waiting;
  int path = -1;          ///< index into the plan; -1 while it serves none
  double target_n = 0.0;  ///< what the technique asks for now; 0 outside of a contact
  double measured_n = 0.0;
  Vector3 tool_in_base = Vector3::Zero();  ///< foremost point of the tool
};

/// How one path of the plan went, in session time.
struct Performed {
  int path = 0;
  Arm arm = Arm::left;
  double begin_s = 0.0;  ///< of the contact
  double end_s = 0.0;
  control::Trouble trouble = control::Trouble::none;  ///< why it was cut short, if it was
  bool whole = true;                                  ///< from its first point to its last
  std::optional<TissueEstimate> felt;                 ///< after its last press; only pressing feels
  double chi = 1.0;                                   ///< misfit of what was felt; about 1 is good
  double stiffness_sd = 0.0;  ///< relative, of its tangent stiffness at `reference_force_n`
};

struct Stop {
  double time_s = 0.0;
  Arm arm = Arm::left;
  safety::Cause cause = safety::Cause::none;
  int joint = -1;        ///< that does not stand as planned
  double off_rad = 0.0;  ///< by how much
};
/// For people, in one line: which arm, and why.
[[nodiscard]] std::string explain(const Stop& stop);

/// An arm that leaves its parking place farther than this from the posture that the plan begins
/// with stays where it is: nobody has looked what lies on its way.
inline constexpr double parked_within_rad = 0.35;

struct MassageOptions {
  Transform base_from_couch = Transform::Identity();  ///< as the session believes it
  double rail_m = 0.0;
  double standoff_m = 40e-3;
  double force_ceiling_n = 45.0;
  double torso_n_per_m = 35e3;  ///< literature value; this person's own is not known
  bool steer = true;            ///< the estimate is fed forward as soon as it has converged
  bool adaptive = true;         ///< what is felt decides how hard the presses may be
  double max_shift_m = 10e-3;   ///< of the skin against the scan; beyond, a new scan is needed
  std::vector<robot::Obstacle> obstacles = {};  ///< that the arms keep away from
};

/// The massage itself, one millisecond at a time: travel, approach, contact, retract, for both
/// arms, one step of the plan after the other. What it knows of the world comes in with the
/// readings; what goes out has passed the guard. Memory is taken in the constructor; `step` is
/// real-time.
class MassageStep {
 public:
  MassageStep(const massage::Plan& plan, PerArm<std::vector<motion::ArmJob>> jobs,
              const PerArm<robot::ArmModel>& models, const MassageOptions& options);

  [[nodiscard]] robot::RobotCommand step(const robot::RobotReading& reading) noexcept;

  /// Takes effect in the next step, and shows within 100 ms. Call it between two steps.
  void obey(LiveCommand command) noexcept;

  /// True when every job is done, or after a stop when the arms have let go.
  [[nodiscard]] bool finished() const noexcept { return finished_; }
  [[nodiscard]] const PerArm<ArmView>& view() const noexcept { return view_; }
  [[nodiscard]] const std::vector<Performed>& performed() const noexcept { return performed_; }
  [[nodiscard]] const std::vector<Stop>& stops() const noexcept { return stops_; }
  [[nodiscard]] const std::vector<Decision>& decisions() const noexcept {
    return steering_.decisions();
  }
  /// The person lies elsewhere than scanned: the arms let go, fly to where they started, and a new
  /// scan is needed.
  [[nodiscard]] bool wants_scan() const noexcept { return wants_scan_; }
  /// How far the skin was found from the scan, from the contacts so far.
  [[nodiscard]] const Vector3& shift_in_base() const noexcept { return shift_in_base_; }
  /// Between the surfaces of the arms as measured, in the last millisecond.
  [[nodiscard]] double arm_distance_m() const noexcept { return separation_.apart_m(); }

 private:
  struct Side {
    Side(const robot::ArmModel& model, const MassageOptions& options);
    control::ArmController controller;
    safety::Guard guard;
    std::vector<motion::ArmJob> jobs = {};
    std::size_t job = 0;
    std::size_t waypoint = 0;
    double leg_s = 0.0;     ///< when the present leg of the way began
    double amiss_s = -1.0;  ///< since when it has not stood as planned though it should leave
    ArmPhase phase = ArmPhase::waiting;
    double contact_s = 0.0;
    Playback playback = {};
    bool skip = false, again = false, cut_short = false;
    std::array<control::ToolPose, 3> detour = {};  ///< to where the next way begins, or home
    int detour_at = -1, detour_legs = 0;
    control::Trouble trouble = control::Trouble::none;
    TangentTissue expected = {};  ///< fed forward
    ContactPoint wanted = {};     ///< of the path, now; places in base
    JointVector q_rad = {};       ///< as measured in this millisecond
    control::ToolPose home = {};  ///< where the session began
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
  void feel(Side& side, Arm arm, double time_s, const ArmState& state) noexcept;
  void let_go(double time_s) noexcept;
  void leave(double time_s) noexcept;
  void detour(Side& side, const control::ToolPose& goal, bool from_above, double time_s) noexcept;
  void fly_home(Side& side, double time_s) noexcept;
  void part_arms(double time_s) noexcept;
  [[nodiscard]] const motion::ArmJob* job_of(const Side& side) const noexcept;
  [[nodiscard]] const massage::PlannedPath* path_of(const Side& side) const noexcept;
  [[nodiscard]] safety::Proposal proposal(const Side& side,
                                          const JointVector& torque_nm) const noexcept;

  massage::Plan plan_;  // its paths in base
  PerArm<robot::ArmModel> models_;
  motion::ArmSeparation separation_;
  MassageOptions options_;
  PerArm<Side> sides_;
  Steering steering_;
  PerArm<ArmView> view_;
  int step_ = 0;
  double intensity_ = 1.0;
  bool paused_ = false, stop_asked_ = false, wants_scan_ = false;
  Vector3 shift_in_base_ = Vector3::Zero(), next_shift_in_base_ = Vector3::Zero();
  bool started_ = false;
  bool finished_ = false;
  double stopped_s_ = -1.0;
  double tool_radius_m_ = 0.0;
  std::vector<Performed> performed_;
  std::vector<Stop> stops_;
};

}  // namespace tuina::session
