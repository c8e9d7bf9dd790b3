// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/motion/arm_job.hpp"
#include "tuina/motion/arm_move.hpp"

namespace tuina::motion {

/// Sequences the moves of two arms so that they keep apart for any timing within a step: both at
/// once if their distance allows, else one after the other with the idle arm out of the way.
class TwoArmSchedule {
 public:
  /// The arms and what is around them.
  explicit TwoArmSchedule(Stage stage);

  /// Adds one step of the plan, at most one path per arm. Infeasible paths are left out, with the
  /// reason in `notes`.
  void add_step(PerArm<const massage::PlannedPath*> paths);
  /// Moves both arms back to their start. Leaves the last paths out, with the reason in `notes`,
  /// where no way back keeps the arms apart.
  void finish();

  /// Paths that are kept, with their new steps and times, and the jobs of each arm in order.
  std::vector<massage::PlannedPath> paths;
  PerArm<std::vector<ArmJob>> jobs;
  std::vector<Sentence> notes;
  double min_arm_distance_m;  ///< for any timing within a step
  robot::Clearances clear;    ///< minimum distances of both arms from couch and robot body
  double end_s;               ///< nominal end of the last job
  std::size_t left_out = 0;
  double lowered_n = 0.0;  ///< sum over all paths of what their forces were lowered by

 private:
  using Moves = PerArm<const ArmMove*>;
  [[nodiscard]] double apart_m(const JointPath& left, const JointPath& right) const;
  [[nodiscard]] double apart_m(Arm arm, const JointPath& its, const JointPath& of_other) const;
  [[nodiscard]] Result<ArmMove> plan_move(Arm arm, const massage::PlannedPath& planned) const;
  [[nodiscard]] bool strays_less_from_home(Arm arm, const massage::PlannedPath& planned,
                                           const ArmMove& move) const;
  enum class Pair : std::uint8_t { together, too_close, out_of_reach };
  Pair plan_pair(const PerArm<const massage::PlannedPath*>& both);
  void plan_single(Arm arm, const massage::PlannedPath& planned);
  void add_transfer(Arm arm, const ArmMove& move);
  void add_contacts(const Moves& moves, const PerArm<const massage::PlannedPath*>& planned);
  [[nodiscard]] massage::PlannedPath bearable(const massage::PlannedPath& planned, double mass_kg);
  void add_job(Arm arm, int path, const std::vector<control::ToolPose>& way,
               const JointVector& posture_rad);
  void leave_out(const massage::PlannedPath& planned, double apart_m);

  /// Ways of both arms home: at once, or one after the other.
  struct WayHome {
    PerArm<ArmMove> moves;
    bool at_once = false;
    Arm first = Arm::left;
    double apart_m = 0.0;
  };
  /// A move of one arm out of the other one's way, and the ways home after it.
  struct WayRound {
    Arm arm = Arm::left;
    ArmMove aside;
    WayHome home;
    double apart_m = 0.0;
  };
  [[nodiscard]] WayHome way_home(const PerArm<ArmRest>& rest) const;
  [[nodiscard]] std::optional<WayRound> way_round() const;
  void go_home(const WayHome& way);

  /// How far the plan was, with both arms at home and after each contact since.
  struct Mark {
    PerArm<ArmRest> rest;
    PerArm<std::size_t> jobs;
    std::size_t paths;
    double min_arm_distance_m;
    robot::Clearances clear;
    double end_s, lowered_n;
    int job_step, path_step;
  };
  [[nodiscard]] Mark mark() const;
  void leave_last_out(double apart_m);

  std::vector<Mark> marks_;
  Stage stage_;
  PerArm<ArmRest> rest_;
  int job_step_ = 0;
  int path_step_ = 0;
};

}  // namespace tuina::motion
