// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "tuina/hardware/wrist_sensor.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::hardware {

/// A robot whose wrists have sensors of their own: the wrench of a reading is the sensor's, with
/// the time of its sample on the clock of the reading, the rest is the arms'. A sensor that fails
/// gives no newer sample, and the guard knows by the old time; an arm without one keeps what the
/// arm says. Where the tool that a sensor was calibrated with is not quite the table's, the wrench
/// is the one that the table's tool would give.
class WristRobot final : public robot::Robot {
 public:
  /// By what a sample ages: the host's steady clock, or that of arms which are simulated and wait
  /// for their host, whose time is then the sensors' too.
  enum class Clock : std::uint8_t { host, arms };

  /// `arms` must outlive this. Fails with Fault::device when a sensor fails, with Fault::config
  /// when its zero is not known, or when the tool it was calibrated with has another mass than the
  /// table's by 50 g or more, which the guard would take for a force.
  [[nodiscard]] static Result<std::unique_ptr<WristRobot>> open(
      robot::Robot& arms, const PerArm<std::optional<WristDevice>>& devices,
      const robot::ArmTable& table, const robot::RobotMount& mount, Clock clock = Clock::host);

  /// Zeroes the sensors that are to be zeroed at the start, once the arms stand.
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override { return arms_.fault(); }
  /// Nobody reads for a while.
  void rest() noexcept { resting_ = true; }

  /// Null where the arm has no sensor of its own.
  [[nodiscard]] const WristSensor* sensor(Arm arm) const noexcept {
    return sensors_[arm] ? &*sensors_[arm] : nullptr;
  }

 private:
  WristRobot(robot::Robot& arms, PerArm<robot::ArmModel> models, double tool_mass_kg, Clock clock)
      : arms_(arms), models_(std::move(models)), tool_mass_kg_(tool_mass_kg), clock_(clock) {}
  [[nodiscard]] Wrench in_tool(Arm arm, const robot::RobotReading& reading) const noexcept;

  robot::Robot& arms_;
  PerArm<robot::ArmModel> models_;
  double tool_mass_kg_;
  Clock clock_;
  PerArm<std::optional<WristSensor>> sensors_;
  PerArm<double> sample_time_s_ = {};  ///< on the clock of the readings
  PerArm<bool> told_ = {};
  bool resting_ = true;
};

}  // namespace tuina::hardware
