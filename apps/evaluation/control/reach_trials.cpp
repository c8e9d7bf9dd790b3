// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/reach_trials.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tuina/control/arm_controller.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"

namespace tuina::app {
namespace {

using robot::Matrix6;
using robot::Vector6;

/// [thesis] (3.5) as printed, in all six dimensions, no force from outside.
JointVector printed_law(const robot::ArmDynamics& dynamics, const JointVector& dq,
                        const control::ToolReference& reference, const Matrix3& turn,
                        const control::ThesisImpedance& impedance) {
  const double K = impedance.stiffness_n_per_m;
  const double D = 2.0 * 0.7 * std::sqrt(impedance.mass_kg * K);
  const Eigen::AngleAxisd off(dynamics.base_from_tool.linear() * turn.transpose());
  Vector6 error;
  error << dynamics.base_from_tool.translation() - reference.pose.at_in_base,
      off.angle() * off.axis();
  Vector6 speed = dynamics.jacobian * dq;
  speed.head<3>() -= reference.velocity_m_per_s;
  const Vector6 wanted = (-D * speed - K * error) / impedance.mass_kg - dynamics.jacobian_dot_dq;
  const Matrix6 J = dynamics.jacobian;
  return dynamics.mass_kg_m2 * J.inverse() * wanted;
}

template <typename Law>
BeyondReach pull(const char* name, const robot::ArmModel& arm, const Law& law) {
  constexpr double step_s = 0.25e-3, pulled_m = 0.2, pull_m_per_s = 0.1;
  JointVector q = JointVector::Zero(arm.joints()), dq = q;
  q.head<6>() << -0.3, -0.2, 0.1, 0.4, 0.3, -0.2;
  const Transform start = arm.base_from_tool(q, 0.0);
  const Vector3 shoulder = arm.shoulder_in_base(0.0);
  const Vector3 outward = (start.translation() - shoulder).normalized();
  const double start_m = (start.translation() - shoulder).norm();
  const double way_m = arm.reach_m() - start_m + pulled_m;
  BeyondReach result{.law = name};
  JointVector torque = JointVector::Zero(arm.joints());
  const int steps = static_cast<int>((way_m / pull_m_per_s + 2.0) / step_s);
  for (int n = 0; n < steps; ++n) {
    const auto dynamics = arm.evaluate(q, dq, 0.0);
    if (n % 4 == 0) {
      const double gone_m = std::min(pull_m_per_s * n * step_s, way_m);
      control::ToolReference reference;
      reference.pose = {start.translation() + gone_m * outward, control::tool_normal(start)};
      if (gone_m < way_m) reference.velocity_m_per_s = pull_m_per_s * outward;
      torque = law(dynamics, q, dq, reference, start.linear());
    }
    const JointVector given = torque + dynamics.coriolis_nm + dynamics.gravity_nm;
    result.max_torque_nm = std::max(result.max_torque_nm, given.cwiseAbs().maxCoeff());
    if (!given.allFinite() || result.max_torque_nm > 1e6) {
      result.survived = false;
      return result;
    }
    dq += step_s * dynamics.mass_kg_m2.llt().solve(torque);
    q += step_s * dq;
    result.max_speed_rad_per_s = std::max(result.max_speed_rad_per_s, dq.cwiseAbs().maxCoeff());
  }
  return result;
}

/// The largest factor of `push_nm` that keeps every joint within its drive beside gravity.
double max_force_n(const robot::ArmTable& table, const JointVector& gravity_nm,
                   const JointVector& push_nm) {
  double max_n = 1e9;
  for (Eigen::Index i = 0; i < push_nm.size(); ++i) {
    const double limit = table.links[static_cast<std::size_t>(i)].torque_limit_nm;
    const double room = limit - std::copysign(1.0, push_nm[i]) * gravity_nm[i];
    max_n = std::min(max_n, room / std::max(std::abs(push_nm[i]), 1e-9));
  }
  return std::max(max_n, 0.0);
}

}  // namespace

std::vector<BeyondReach> pull_beyond_reach() {
  const robot::ArmModel arm(robot::thesis_arm(), robot::mount_for(BodyPosture::sitting), Arm::left);
  const control::ThesisImpedance impedance = {.mass_kg = 4.0, .below_apparent_mass = true};
  const JointVector none = JointVector::Zero(0);
  return {pull("(3.5), J^-1 as printed", arm,
               [&](const auto& dynamics, const auto&, const auto& dq, const auto& reference,
                   const Matrix3& turn) {
                 return printed_law(dynamics, dq, reference, turn, impedance);
               }),
          pull("(3.5), damped inverse", arm,
               [&](const auto& dynamics, const auto& q, const auto& dq, const auto& reference,
                   const Matrix3&) {
                 return control::thesis_torque(dynamics, arm.table(), q, dq,
                                               dynamics.jacobian.template topRows<3>() * dq,
                                               Vector3::Zero(), reference, none, impedance, {}, {});
               }),
          pull("tuina, J^T with a bounded pull", arm,
               [&](const auto& dynamics, const auto& q, const auto& dq, const auto& reference,
                   const Matrix3&) {
                 const control::ArmController::Options options;
                 const Vector3 error =
                     reference.pose.at_in_base - dynamics.base_from_tool.translation();
                 const Vector3 speed = dynamics.jacobian.template topRows<3>() * dq;
                 const double K = options.stiffness_n_per_m;
                 const double D = 2.0 * options.damping_ratio * std::sqrt(4.0 * K);
                 const double share =
                     std::min(1.0, options.max_pull_n / std::max(K * error.norm(), 1e-9));
                 return control::task_torque(
                     dynamics, arm.table(), q, dq,
                     share * K * error + D * (reference.velocity_m_per_s - speed), reference, none,
                     options.turning, options.posture);
               })};
}

ForceAtTool force_at_tool() {
  const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
  const PerArm<robot::ArmModel> arms{
      .of = {robot::ArmModel(robot::thesis_arm(), mount, Arm::left),
             robot::ArmModel(robot::thesis_arm(), mount, Arm::right)}};
  const PerArm<const robot::ArmModel*> pointers{.of = {&arms[Arm::left], &arms[Arm::right]}};
  const PerArm<JointVector> ready = robot::ready_posture(robot::thesis_arm(), mount);
  PerArm<std::vector<robot::ContactGoal>> goals;
  const Vector3 normal_in_couch = Vector3::UnitY();
  for (int row = 0; row <= 9; ++row) {
    for (int column = -4; column <= 4; ++column) {
      const Vector3 at_in_couch(0.05 * column, 0.03, 0.2 + 0.05 * row);
      for (const Arm arm : both_arms) {
        const double to_its_side_m = arm == Arm::left ? at_in_couch.x() : -at_in_couch.x();
        if (to_its_side_m < -30_mm) continue;
        goals[arm].push_back({.at_in_base = mount.base_from_couch * at_in_couch,
                              .normal_in_base = mount.base_from_couch.linear() * normal_in_couch});
      }
    }
  }
  const double rail_m = robot::choose_rail(pointers, mount, goals, ready).value_or(0.0);
  ForceAtTool result{.reach_m = arms[Arm::left].reach_m()};
  std::vector<double> forces;
  for (const Arm arm : both_arms) {
    for (const robot::ContactGoal& goal : goals[arm]) {
      ++result.places;
      const auto posture = robot::find_posture(arms[arm], rail_m, goal, ready[arm]);
      if (posture.reach != robot::Reach::reached) continue;
      ++result.reached;
      const auto dynamics =
          arms[arm].evaluate(posture.q_rad, JointVector::Zero(arms[arm].joints()), rail_m);
      const JointVector push_nm = dynamics.jacobian.topRows<3>().transpose() * -goal.normal_in_base;
      forces.push_back(max_force_n(arms[arm].table(), dynamics.gravity_nm, push_nm));
    }
  }
  std::sort(forces.begin(), forces.end());
  if (!forces.empty()) {
    result.min_n = forces.front();
    result.median_n = forces[forces.size() / 2];
  }
  return result;
}

}  // namespace tuina::app
