// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "tuina/robot/robot.hpp"

namespace tuina::tests {

/// A robot without a world: its arms stand still whatever the torques are. The script says what
/// goes wrong, counted in milliseconds.
class FakeRobot final : public robot::Robot {
 public:
  static constexpr int never = std::numeric_limits<int>::max();
  struct Script {
    int silent_from = never;  ///< no readings from this one on ...
    int silent_for = never;   ///< ... for so many
    int fault_at = never;     ///< the device says that it is broken
    bool refuses_to_stand = false;
    Vector3 wrench_n = Vector3::Zero();  ///< what the wrist sensors say
    bool measures_torque = false;        ///< the drives tell what they were told
  };
  FakeRobot() = default;
  explicit FakeRobot(const Script& script) : script_(script) {}

  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override {
    if (script_.refuses_to_stand) return fail(Fault::device, "the brakes do not open");
    for (const Arm arm : both_arms) {
      now_.arms[arm].q_rad = pose.q_rad[arm];
      now_.arms[arm].dq_rad_per_s = JointVector::Zero(pose.q_rad[arm].size());
      now_.arms[arm].wrench_in_tool.force_n = script_.wrench_n;
    }
    now_.rail_m = pose.rail_m;
    ++stood;
    return {};
  }
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override {
    const int ms = reads++;
    now_.tick = static_cast<std::uint64_t>(ms);
    now_.time_s = ms * control_period_s;
    for (robot::ArmReading& arm : now_.arms.of) {
      arm.wrench_time_s = now_.time_s;
      arm.wrench_in_tool.torque_nm.z() = 1e-9 * ms;  // no living sensor repeats itself
    }
    for (const Arm arm : both_arms)
      if (script_.measures_torque) now_.arms[arm].measured_torque_nm = last.torque_nm[arm];
    const bool silent = ms >= script_.silent_from && ms - script_.silent_from < script_.silent_for;
    return silent ? std::nullopt : std::optional(now_);
  }
  void apply(const robot::RobotCommand& command) noexcept override {
    last = command;
    ++applied;
  }
  [[nodiscard]] const char* fault() const noexcept override {
    return reads > script_.fault_at ? "drive 3 is too hot" : nullptr;
  }

  int reads = 0, applied = 0, stood = 0;
  robot::RobotCommand last;

 private:
  Script script_ = {};
  robot::RobotReading now_;
};

}  // namespace tuina::tests
