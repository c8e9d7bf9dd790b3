// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/cartesian_impedance.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "tuina/robot/tool_task.hpp"

namespace tuina::control {
namespace {

using Matrix5 = Eigen::Matrix<double, 5, 5>;

// Floor of the task mobility: near singular poses the task inertia is capped at 50 kg.
constexpr double mobility_floor = 0.02;

/// Moment that turns the axis of the tool to its reference.
Vector3 turning_nm(const robot::ArmDynamics& dynamics, const JointVector& dq,
                   const ToolReference& reference, const TurningGains& gains) {
  const Vector3 axis = tool_normal(dynamics.base_from_tool);
  const Vector3 cross = axis.cross(reference.pose.normal_in_base);
  const double sine = cross.norm();
  const double angle = std::atan2(sine, axis.dot(reference.pose.normal_in_base));
  const Vector3 error = sine > 1e-9 ? Vector3(cross * (angle / sine)) : Vector3(cross);
  const Vector3 omega = dynamics.jacobian.bottomRows<3>() * dq;
  // Damping for 0.05 kg m2: a wrist with its rotors.
  const double damping = 2.0 * gains.damping_ratio * std::sqrt(gains.stiffness_nm_per_rad * 0.05);
  Vector3 spring = gains.stiffness_nm_per_rad * error;
  spring *= std::min(1.0, gains.max_nm / std::max(spring.norm(), 1e-9));
  Vector3 moment = spring + damping * (reference.turning_rad_per_s - omega);
  return moment - axis * axis.dot(moment);
}

JointVector posture_torque(const robot::ArmTable& table, const JointVector& q,
                           const JointVector& dq, const JointVector& posture_rad,
                           const PostureGains& gains) {
  JointVector torque = -gains.damping_nm_s_per_rad * dq;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (posture_rad.size() == q.size()) {
      const double error =
          std::clamp(posture_rad[i] - q[i], -gains.max_error_rad, gains.max_error_rad);
      torque[i] += gains.stiffness_nm_per_rad * error;
    }
    const robot::Link& link = table.links[static_cast<std::size_t>(i)];
    const double below = link.min_rad + gains.limit_margin_rad - q[i];
    const double above = q[i] - (link.max_rad - gains.limit_margin_rad);
    torque[i] += gains.limit_stiffness_nm_per_rad * (std::max(below, 0.0) - std::max(above, 0.0));
  }
  return torque;
}

// Nullspace torque, which does not accelerate the task: (1 - J^T Lambda J M^-1) torque,
// [khatib1987].
JointVector beside_task(const robot::ArmDynamics& dynamics, const JointVector& torque) {
  const robot::ToolJacobian J = robot::tool_jacobian(dynamics.base_from_tool, dynamics.jacobian);
  const Eigen::LLT<JointMatrix> mass(dynamics.mass_kg_m2);
  Eigen::Matrix<double, Eigen::Dynamic, 5, 0, max_joints, 5> mobile = J.transpose();
  mass.solveInPlace(mobile);
  const Matrix5 mobility = J * mobile + mobility_floor * Matrix5::Identity();
  const robot::ToolError acceleration = mobile.transpose() * torque;
  const robot::ToolError force = mobility.llt().solve(acceleration);
  return torque - J.transpose() * force;
}

}  // namespace

JointVector task_torque(const robot::ArmDynamics& dynamics, const robot::ArmTable& table,
                        const JointVector& q_rad, const JointVector& dq_rad_per_s,
                        const Vector3& force_n, const ToolReference& reference,
                        const JointVector& posture_rad, const TurningGains& turning,
                        const PostureGains& posture) noexcept {
  const Vector3 turn_nm = turning_nm(dynamics, dq_rad_per_s, reference, turning);
  const JointVector rest = posture_torque(table, q_rad, dq_rad_per_s, posture_rad, posture);
  return dynamics.jacobian.topRows<3>().transpose() * force_n +
         dynamics.jacobian.bottomRows<3>().transpose() * turn_nm + beside_task(dynamics, rest);
}

JointVector lead_through_torque(const robot::ArmTable& table, const JointVector& q_rad,
                                const JointVector& dq_rad_per_s,
                                const PostureGains& gains) noexcept {
  return posture_torque(table, q_rad, dq_rad_per_s, JointVector::Zero(0), gains);
}

// With Lambda = (J M^-1 J^T)^-1 of the tool centre, (3.5) reads
// tau = J^T Lambda {M_e^-1 [F - D x~' - K x~] - J' q'} + C + G - J^T F.
// The damping of the inverse is the one on J M^-1 J^T.
JointVector thesis_torque(const robot::ArmDynamics& dynamics, const robot::ArmTable& table,
                          const JointVector& q_rad, const JointVector& dq_rad_per_s,
                          const Vector3& tool_velocity_m_per_s, const Vector3& force_on_tool_n,
                          const ToolReference& reference, const JointVector& posture_rad,
                          const ThesisImpedance& impedance, const TurningGains& turning,
                          const PostureGains& posture) noexcept {
  const Matrix3 mobility = robot::tool_mobility(dynamics).topLeftCorner<3, 3>();
  const Matrix3 inertia =
      (mobility + mobility_floor * Matrix3::Identity()).llt().solve(Matrix3::Identity());
  const Vector3 normal = reference.pose.normal_in_base;
  const double apparent = robot::apparent_mass_kg(dynamics, normal);
  const double mass =
      impedance.below_apparent_mass ? impedance.mass_kg : std::max(impedance.mass_kg, apparent);
  const double K = impedance.stiffness_n_per_m;
  const double D = impedance.damping_n_s_per_m > 0.0 ? impedance.damping_n_s_per_m
                                                     : 2.0 * 0.7 * std::sqrt(mass * K);
  const Vector3 x_error = dynamics.base_from_tool.translation() - reference.pose.at_in_base;
  const Vector3 v_error = tool_velocity_m_per_s - reference.velocity_m_per_s;
  const Vector3 acceleration =
      (force_on_tool_n - D * v_error - K * x_error) / mass - dynamics.jacobian_dot_dq.head<3>();
  const Vector3 force = inertia * acceleration - force_on_tool_n;
  return task_torque(dynamics, table, q_rad, dq_rad_per_s, force, reference, posture_rad, turning,
                     posture);
}

JointVector joint_impedance_torque(const robot::ArmDynamics& dynamics, const JointVector& q_rad,
                                   const JointVector& dq_rad_per_s, const JointVector& q_goal_rad,
                                   const JointVector& dq_goal_rad_per_s,
                                   const JointVector& ddq_goal_rad_per_s2,
                                   const JointVector& stiffness_nm_per_rad,
                                   double damping_ratio) noexcept {
  JointVector torque = dynamics.mass_kg_m2 * ddq_goal_rad_per_s2;
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    const double damping =
        2.0 * damping_ratio * std::sqrt(stiffness_nm_per_rad[i] * dynamics.mass_kg_m2(i, i));
    torque[i] += stiffness_nm_per_rad[i] * (q_goal_rad[i] - q_rad[i]) +
                 damping * (dq_goal_rad_per_s[i] - dq_rad_per_s[i]);
  }
  return torque;
}

}  // namespace tuina::control
