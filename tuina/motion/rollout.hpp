// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "tuina/control/tool_motion.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::motion {

/// Joint configurations of one arm along a motion, a few degrees apart.
struct JointPath {
  std::vector<JointVector> q_rad;
  std::vector<robot::ArmModel::Kinematics> poses;
  double tool_error_m = 0.0;  ///< tool position error: after a transfer leg, maximum on the skin
  double limit_excess_rad = 0.0;  ///< maximum penetration of the joint-limit springs
  /// Minimum height of the elbow above the tangent plane of the touched skin.
  double elbow_height_m = std::numeric_limits<double>::infinity();

  /// Farthest reach past the midline between the shoulders; negative on the arm's own side. Two
  /// arms stay at least minus the sum of both values apart.
  [[nodiscard]] double inward_m(const robot::ArmModel& model, Arm arm) const noexcept;
};
/// Reach past the midline of one configuration.
[[nodiscard]] double inward_m(const robot::ArmModel& model, Arm arm,
                              const robot::ArmModel::Kinematics& pose) noexcept;

/// Simulates one arm kinematically: the tool follows the controller's reference while its nullspace
/// is drawn to a posture as the controller's posture springs do.
class Rollout {
 public:
  /// `posture_share`: fraction of the remaining posture error corrected per step of 15 mm, at most
  /// of `max_pull_rad` of it.
  Rollout(const robot::ArmModel& model, double rail_m, const JointVector& q_rad,
          double posture_share, double max_pull_rad = std::numeric_limits<double>::infinity());

  /// Straight transfer through the air, the normal turning evenly.
  void transfer(const control::ToolPose& tip, const JointVector& posture_rad,
                JointPath& joint_path);
  /// Tool at rest while the nullspace takes some steps towards the posture.
  void settle(const JointVector& posture_rad, JointPath& joint_path, int steps = 10);
  /// Contact along the skin.
  void slide(std::span<const robot::ContactGoal> places, const JointVector& posture_rad,
             JointPath& joint_path);

  /// Joint angles now.
  [[nodiscard]] const JointVector& q_rad() const noexcept { return q_rad_; }
  /// Tool position error now; an arm that got stuck keeps one.
  [[nodiscard]] double tool_error_m() const noexcept { return tool_error_m_; }

 private:
  void step_to(const Vector3& centre_in_base, const Vector3& normal_in_base,
               const JointVector& posture_rad, JointPath& joint_path);
  [[nodiscard]] JointVector posture_drift(const JointVector& posture_rad) const;

  const robot::ArmModel* model_;
  double rail_m_;
  JointVector q_rad_;
  robot::ArmModel::Kinematics now_;  // kinematics of q_rad_
  double posture_share_;
  double max_pull_rad_;
  double tool_error_m_ = 0.0;
};

/// Minimum distance between the surfaces of two arms, for any timing along their paths.
[[nodiscard]] double distance_between_m(const PerArm<robot::ArmModel>& models,
                                        const PerArm<const JointPath*>& joint_paths);

}  // namespace tuina::motion
