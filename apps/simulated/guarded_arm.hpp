// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/control/arm_controller.hpp"
#include "tuina/safety/guard.hpp"

namespace tuina::app {

/// One arm with its gate, as every session drives it.
struct GuardedArm {
  control::ArmController controller;
  safety::Guard guard;
  safety::Verdict verdict;
  ArmState state;

  GuardedArm(const robot::ArmModel& model, const control::ArmController::Options& options)
      : controller(model, options), guard({.torque_limit_nm = model.table().torque_limits_nm()}) {}

  void sense(const robot::RobotReading& reading, Arm arm) noexcept {
    state = controller.sense(reading.arms[arm], reading.time_s, reading.rail_m);
  }

  const JointVector& step(const robot::RobotReading& reading, Arm arm) noexcept {
    const JointVector torque = controller.step(state, reading.rail_m, 1e-3);
    const control::ArmStatus& status = controller.status();
    constexpr std::array phase_of = {safety::Phase::free,     safety::Phase::free,
                                     safety::Phase::approach, safety::Phase::contact,
                                     safety::Phase::retract,  safety::Phase::free};
    return allow(reading, arm, controller.dynamics(),
                 {.torque_nm = torque,
                  .phase = phase_of[static_cast<std::size_t>(status.doing)],
                  .zone = safety::Zone::bench,
                  .set_force_n = status.set_force_n,
                  .normal_in_base = status.normal_in_base,
                  .virtual_target_in_base = status.virtual_target_in_base,
                  .stiffness_n_per_m = status.stiffness_n_per_m});
  }

  /// What the gate makes of somebody's proposal for this tick.
  const JointVector& allow(const robot::RobotReading& reading, Arm arm,
                           const robot::ArmDynamics& dynamics,
                           const safety::Proposal& proposal) noexcept {
    const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, max_joints> jacobian =
        dynamics.jacobian.topRows<3>();
    verdict = guard.check({.tick = reading.tick,
                           .time_s = reading.time_s,
                           .wrench_time_s = reading.arms[arm].wrench_time_s,
                           .q_rad = state.q_rad,
                           .dq_rad_per_s = state.dq_rad_per_s,
                           .force_in_base_n = state.contact_in_base.force_n,
                           .tool_in_base = dynamics.base_from_tool.translation(),
                           .tool_velocity_m_per_s = jacobian * state.dq_rad_per_s,
                           .jacobian = jacobian,
                           .gravity_nm = dynamics.gravity_nm},
                          proposal);
    return verdict.allowed_nm;
  }
};

}  // namespace tuina::app
