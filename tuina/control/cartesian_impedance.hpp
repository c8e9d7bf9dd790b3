// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/tool_motion.hpp"
#include "tuina/robot/arm_model.hpp"

namespace tuina::control {

/// Clamps the length of a vector and keeps its direction.
[[nodiscard]] inline Vector3 clamp_norm(const Vector3& vector, double max_length) {
  const double length = vector.norm();
  return length > max_length ? Vector3(vector * (max_length / length)) : vector;
}

/// Springs and dampers of the nullspace posture and of the joint limits.
struct PostureGains {
  double stiffness_nm_per_rad = 6.0;
  double damping_nm_s_per_rad = 4.0;
  double max_error_rad = 0.5;      ///< of a joint; farther off its spring pulls no harder
  double limit_margin_rad = 0.15;  ///< distance to a joint limit where its spring begins
  double limit_stiffness_nm_per_rad = 60.0;
};

/// The spring and damper that align the tool's axis.
struct TurningGains {
  double stiffness_nm_per_rad = 60.0;
  double damping_ratio = 0.8;
  double max_nm = 6.0;  ///< limit of the spring
};

/// Joint torques of a force on the tool centre and a spring that aligns the tool axis with a
/// normal. J^T without inertia shaping or an inverse of J, so that torques stay bounded in singular
/// poses. The task has five dimensions (rotation about the axis is free); the nullspace follows the
/// posture.
[[nodiscard]] JointVector task_torque(const robot::ArmDynamics& dynamics,
                                      const robot::ArmTable& table, const JointVector& q_rad,
                                      const JointVector& dq_rad_per_s, const Vector3& force_n,
                                      const ToolReference& reference,
                                      const JointVector& posture_rad, const TurningGains& turning,
                                      const PostureGains& posture) noexcept;

/// Damping and joint-limit springs only, for an arm guided by hand.
[[nodiscard]] JointVector lead_through_torque(const robot::ArmTable& table,
                                              const JointVector& q_rad,
                                              const JointVector& dq_rad_per_s,
                                              const PostureGains& gains) noexcept;

/// Target impedance of [thesis] (3.2), equal in all directions.
struct ThesisImpedance {
  double mass_kg = 4.0;
  double damping_n_s_per_m = 0.0;  ///< zero or less: 2 0.7 sqrt(M K), [thesis] 6.3.1 as meant
  double stiffness_n_per_m = 2000.0;
  bool below_apparent_mass = false;  ///< allows a mass that limit-cycles on stiff tissue
};

/// Torques of [thesis] (3.5) for the tool centre: inertia shaping with the measured force, and a
/// damped inverse of J in place of J^-1. A mass below the arm's apparent mass is raised to it
/// unless allowed: below it the law is force feedback with a gain above one and a delayed sensor.
[[nodiscard]] JointVector thesis_torque(
    const robot::ArmDynamics& dynamics, const robot::ArmTable& table, const JointVector& q_rad,
    const JointVector& dq_rad_per_s, const Vector3& tool_velocity_m_per_s,
    const Vector3& force_on_tool_n, const ToolReference& reference, const JointVector& posture_rad,
    const ThesisImpedance& impedance, const TurningGains& turning,
    const PostureGains& posture) noexcept;

/// [thesis] (3.6)-(3.9) with desired instead of measured acceleration, gravity and coupling from
/// the model: a spring and damper per joint.
[[nodiscard]] JointVector joint_impedance_torque(
    const robot::ArmDynamics& dynamics, const JointVector& q_rad, const JointVector& dq_rad_per_s,
    const JointVector& q_goal_rad, const JointVector& dq_goal_rad_per_s,
    const JointVector& ddq_goal_rad_per_s2, const JointVector& stiffness_nm_per_rad,
    double damping_ratio) noexcept;

}  // namespace tuina::control
