// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/motion/arm_job.hpp"
#include "tuina/motion/arm_move.hpp"

namespace tuina::motion {

/// The moves of two arms in an order in which they keep apart, whatever the timing within a step:
/// both at once where that is far enough, else one after the other, the idle arm out of the way.
class Choreography {
 public:
  explicit Choreography(Stage stage);

  /// The paths of one step of the plan, one per arm at most. What cannot be done is left out, and
  /// the notes say why.
  void dance(PerArm<const massage::PlannedPath*> paths);
  /// Both arms back to where they began.
  void finish();

  /// The paths that are done, with new steps and times, and for each arm its jobs in order.
  std::vector<massage::PlannedPath> paths;
  PerArm<std::vector<ArmJob>> jobs;
  std::vector<std::string> notes;
  double min_arm_distance_m;  ///< whatever the timing within a step
  robot::Clearances clear;    ///< of both arms, from couch and own body
  double end_s;               ///< of the last job, if all goes to plan
  std::size_t left_out = 0;

 private:
  using Moves = PerArm<const ArmMove*>;
  [[nodiscard]] double apart_m(const Passage& left, const Passage& right) const;
  [[nodiscard]] double apart_m(Arm arm, const Passage& its, const Passage& of_other) const;
  [[nodiscard]] Result<ArmMove> plan_move(Arm arm, const massage::PlannedPath& planned) const;
  bool dance_together(const PerArm<const massage::PlannedPath*>& both);
  void dance_alone(Arm arm, const massage::PlannedPath& planned);
  void fly(Arm arm, const ArmMove& move);
  void touch(const Moves& moves, const PerArm<const massage::PlannedPath*>& planned);
  void add_job(Arm arm, int path, const std::vector<control::ToolPose>& way,
               const JointVector& posture_rad);

  Stage stage_;
  PerArm<ArmRest> rest_;
  int job_step_ = 0;
  int path_step_ = 0;
};

}  // namespace tuina::motion
