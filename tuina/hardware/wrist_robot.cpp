// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/hardware/steady_clock.hpp"

namespace tuina::hardware {
namespace {

constexpr double max_mass_off_kg = 0.05;

Result<void> judge(const WristDevice& device, const robot::ArmTable& table) {
  if (!device.calibration && !device.zero_at_start)
    return fail(Fault::config,
                "{}: where this wrist sensor's zero is would be guessed; name its `calibration`, "
                "which `tuina calibrate --wrist` writes, or set `zero_at_start`",
                device.address);
  if (!device.calibration) return {};
  const double mass_kg = device.calibration->mass_kg;
  if (std::abs(mass_kg - table.tool_mass_kg) < max_mass_off_kg) return {};
  return fail(Fault::config,
              "{}: the tool weighs {:.3f} kg by its calibration and {:.3f} kg by the robot's "
              "table; write `mass_kg` into its [tool]",
              device.address, mass_kg, table.tool_mass_kg);
}

}  // namespace

Result<std::unique_ptr<WristRobot>> WristRobot::open(
    robot::Robot& arms, const PerArm<std::optional<WristDevice>>& devices,
    const robot::ArmTable& table, const robot::RobotMount& mount, Clock clock) {
  std::unique_ptr<WristRobot> made(
      new WristRobot(arms, robot::both_models(table, mount), table.tool_mass_kg, clock));
  for (const Arm arm : both_arms) {
    if (!devices[arm]) continue;
    const auto named = [&](const Error& error) {
      return fail(error.fault, "the {} wrist sensor at {}", name_of(arm), error.message);
    };
    if (const auto good = judge(*devices[arm], table); !good) return named(good.error());
    auto sensor = WristSensor::open(*devices[arm]);
    if (!sensor) return named(sensor.error());
    made->sensors_[arm].emplace(std::move(*sensor));
  }
  return made;
}

Result<void> WristRobot::stand_ready(const robot::ReadyPose& pose) {
  if (auto stands = arms_.stand_ready(pose); !stands) return stands;
  resting_ = true;
  for (const Arm arm : both_arms) {
    if (!sensors_[arm] || !sensors_[arm]->stream().device().zero_at_start) continue;
    const auto& known = sensors_[arm]->stream().device().calibration;
    const WristCalibration tool = known.value_or(WristCalibration{.mass_kg = tool_mass_kg_});
    const Matrix3 base_from_tool =
        models_[arm].base_from_tool(pose.q_rad[arm], pose.rail_m).linear();
    if (const auto zeroed = sensors_[arm]->zero(tool.weight_in_tool(base_from_tool)); !zeroed)
      return fail(zeroed.error().fault, "the {} wrist sensor at {}", name_of(arm),
                  zeroed.error().message);
  }
  return {};
}

/// What the sensor says, as if behind it hung the tool of the table.
Wrench WristRobot::in_tool(Arm arm, const robot::RobotReading& reading) const noexcept {
  const WristStream& stream = sensors_[arm]->stream();
  Wrench wrench = stream.in_tool();
  if (!stream.device().calibration) return wrench;
  const Matrix3 base_from_tool =
      models_[arm].base_from_tool(reading.arms[arm].q_rad, reading.rail_m).linear();
  const Wrench believed = WristCalibration{.mass_kg = tool_mass_kg_}.weight_in_tool(base_from_tool);
  const Wrench real = stream.device().calibration->weight_in_tool(base_from_tool);
  wrench.force_n += believed.force_n - real.force_n;
  wrench.torque_nm += believed.torque_nm - real.torque_nm;
  return wrench;
}

std::optional<robot::RobotReading> WristRobot::read() noexcept {
  const bool of_arms = clock_ == Clock::arms;
  for (std::optional<WristSensor>& sensor : sensors_.of)
    if (resting_ && sensor && !of_arms) (void)sensor->begin_anew();
  auto reading = arms_.read();
  if (!reading) return reading;
  for (const Arm arm : both_arms) {
    if (!sensors_[arm]) continue;
    const double now_s = of_arms ? reading->time_s : steady_s();
    const bool anew = resting_ && (!of_arms || sensors_[arm]->begin_anew(now_s));
    const bool fresh = sensors_[arm]->hear(now_s) || anew;
    const WristStream& stream = sensors_[arm]->stream();
    // Only a new sample has a new time: both clocks run unevenly, and a difference of theirs would
    // make an old sample look new.
    if (fresh) {
      const double taken_s = reading->time_s - (now_s - stream.time_s());
      sample_time_s_[arm] = told_[arm] ? std::max(sample_time_s_[arm], taken_s) : taken_s;
      told_[arm] = true;
    }
    reading->arms[arm].wrench_in_tool = in_tool(arm, *reading);
    reading->arms[arm].wrench_time_s = sample_time_s_[arm];
  }
  resting_ = false;
  return reading;
}

void WristRobot::apply(const robot::RobotCommand& command) noexcept {
  arms_.apply(command);
}

}  // namespace tuina::hardware
