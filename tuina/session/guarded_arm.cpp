// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/guarded_arm.hpp"

#include <algorithm>
#include <array>

namespace tuina::session {
namespace {

safety::Guard::Options guard_options(const robot::ArmModel& model, double max_set_force_n) {
  safety::Guard::Options guard{.torque_limit_nm = model.table().torque_limits_nm()};
  for (safety::ForceLimits& limits : guard.force)
    limits.set_n = std::min(limits.set_n, max_set_force_n);
  return guard;
}

}  // namespace

GuardedArm::GuardedArm(const robot::ArmModel& model, const control::ArmController::Options& options,
                       double max_set_force_n)
    : controller(model, options), guard_(guard_options(model, max_set_force_n)) {}

void GuardedArm::sense(const robot::RobotReading& reading, Arm arm) noexcept {
  state = controller.sense(reading.arms[arm], reading.time_s, reading.rail_m);
  if (!started_) controller.start(state);
  started_ = true;
}

JointVector GuardedArm::torque_nm(const robot::RobotReading& reading) noexcept {
  return controller.step(state, reading.rail_m, control_period_s);
}

const JointVector& GuardedArm::allow(const robot::RobotReading& reading, Arm arm,
                                     const robot::ArmDynamics& dynamics,
                                     const safety::Proposal& proposal) noexcept {
  verdict =
      guard_.check({.tick = reading.tick,
                    .time_s = reading.time_s,
                    .wrench_time_s = reading.arms[arm].wrench_time_s,
                    .q_rad = state.q_rad,
                    .dq_rad_per_s = state.dq_rad_per_s,
                    .force_in_base_n = state.contact_in_base.force_n,
                    .tool_in_base = state.base_from_tool.translation(),
                    .tool_velocity_m_per_s = dynamics.jacobian.topRows<3>() * state.dq_rad_per_s,
                    .jacobian = dynamics.jacobian.topRows<3>(),
                    .gravity_nm = dynamics.gravity_nm},
                   proposal);
  return verdict.allowed_nm;
}

const JointVector& GuardedArm::step_on_bench(const robot::RobotReading& reading, Arm arm) noexcept {
  const JointVector torque = torque_nm(reading);
  const control::ArmStatus& status = controller.status();
  constexpr std::array phase_of = {safety::Phase::free,     safety::Phase::free,
                                   safety::Phase::approach, safety::Phase::contact,
                                   safety::Phase::retract,  safety::Phase::free};
  return allow(reading, arm, controller.dynamics(),
               {.torque_nm = torque,
                .phase = phase_of[static_cast<std::size_t>(status.mode)],
                .zone = safety::Zone::bench,
                .set_force_n = status.set_force_n,
                .normal_in_base = status.normal_in_base,
                .virtual_target_in_base = status.virtual_target_in_base,
                .stiffness_n_per_m = status.stiffness_n_per_m});
}

}  // namespace tuina::session
