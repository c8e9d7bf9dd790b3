// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "tuina/control/tool_motion.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::motion {

/// The joint angles that one arm goes through, a few degrees apart.
struct Passage {
  std::vector<JointVector> q_rad;
  std::vector<robot::ArmModel::Kinematics> poses;
  double off_m = 0.0;  ///< of the tool from where it should be: after a leg, at worst on the skin
  double strained_rad = 0.0;  ///< how far a joint was pushed against its end
  /// Of the elbow over the plane of the skin that is touched, at its lowest.
  double elbow_height_m = std::numeric_limits<double>::infinity();

  /// Farthest over the plane midway between the shoulders, towards the other arm; negative when
  /// the arm stays on its own side. Two arms cannot come nearer than minus the sum of theirs.
  [[nodiscard]] double inward_m(const robot::ArmModel& model, Arm arm) const noexcept;
};
/// The same of one posture.
[[nodiscard]] double inward_m(const robot::ArmModel& model, Arm arm,
                              const robot::ArmModel::Kinematics& pose) noexcept;

/// Follows one arm through a massage before it moves: the tool goes where the controller will lead
/// it, what the task leaves free is drawn to a posture as the controller's posture springs do.
class Rehearsal {
 public:
  /// `posture_share`: how much of the way to the wanted posture is gone in each step of 15 mm.
  Rehearsal(const robot::ArmModel& model, double rail_m, const JointVector& q_rad,
            double posture_share);

  /// Through the air in a straight line, the normal turning evenly.
  void fly(const control::ToolPose& foremost, const JointVector& posture_rad, Passage& passage);
  /// Where it is, for as long as its posture changes.
  void stay(const JointVector& posture_rad, Passage& passage);
  /// Along the skin.
  void slide(std::span<const robot::ContactGoal> places, const JointVector& posture_rad,
             Passage& passage);

  [[nodiscard]] const JointVector& q_rad() const noexcept { return q_rad_; }
  /// Of the tool, from where it should be now: an arm that got stuck stays off.
  [[nodiscard]] double off_m() const noexcept { return off_m_; }

 private:
  void step_to(const Vector3& centre_in_base, const Vector3& normal_in_base,
               const JointVector& posture_rad, Passage& passage);
  [[nodiscard]] JointVector drawn_to(const JointVector& posture_rad) const;

  const robot::ArmModel* model_;
  double rail_m_;
  JointVector q_rad_;
  robot::ArmModel::Kinematics now_;  // of q_rad_
  double posture_share_;
  double off_m_ = 0.0;
};

/// The smallest distance between the surfaces of two arms, whatever the one does while the other
/// goes through its passage.
[[nodiscard]] double distance_between_m(const PerArm<robot::ArmModel>& models,
                                        const PerArm<const Passage*>& passages);

}  // namespace tuina::motion
