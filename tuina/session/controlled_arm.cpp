// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/controlled_arm.hpp"

#include <array>

namespace tuina::session {

void ControlledArm::sense(const robot::RobotReading& reading, Arm arm) noexcept {
  state = controller.sense(reading.arms[arm], reading.time_s, reading.rail_m);
  if (!started_) controller.start(state);
  started_ = true;
}

JointVector ControlledArm::torque_nm(const robot::RobotReading& reading) noexcept {
  return controller.step(state, reading.rail_m, control_period_s);
}

safety::Proposal ControlledArm::propose(const robot::RobotReading& reading,
                                        safety::Zone zone) noexcept {
  const JointVector torque = torque_nm(reading);
  const control::ArmStatus& status = controller.status();
  constexpr std::array phase_of = {safety::Phase::free,     safety::Phase::free,
                                   safety::Phase::approach, safety::Phase::contact,
                                   safety::Phase::retract,  safety::Phase::free};
  return {.torque_nm = torque,
          .phase = phase_of[static_cast<std::size_t>(status.mode)],
          .zone = zone,
          .set_force_n = status.set_force_n,
          .normal_in_base = status.normal_in_base,
          .virtual_target_in_base = status.virtual_target_in_base,
          .stiffness_n_per_m = status.stiffness_n_per_m};
}

}  // namespace tuina::session
