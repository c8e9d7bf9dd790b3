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
    const robot::ArmTable& table, const robot::RobotMount& mount) {
  std::unique_ptr<WristRobot> made(
      new WristRobot(arms, robot::both_models(table, mount), table.tool_mass_kg));
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
    const WristCalibration tool = {
        .mass_kg = tool_mass_kg_,
        .com_in_tool_m = known ? known->com_in_tool_m : Vector3(Vector3::Zero()),
        .offset_in_tool = {}};
    const Matrix3 base_from_tool =
        models_[arm].base_from_tool(pose.q_rad[arm], pose.rail_m).linear();
    if (const auto zeroed = sensors_[arm]->zero(tool.weight_in_tool(base_from_tool)); !zeroed)
      return fail(zeroed.error().fault, "the {} wrist sensor at {}", name_of(arm),
                  zeroed.error().message);
  }
  return {};
}

std::optional<robot::RobotReading> WristRobot::read() noexcept {
  for (std::optional<WristSensor>& sensor : sensors_.of)
    if (resting_ && sensor) sensor->begin_anew();
  auto reading = arms_.read();
  if (!reading) return reading;
  for (const Arm arm : both_arms) {
    if (!sensors_[arm]) continue;
    const bool fresh = sensors_[arm]->hear() || resting_;
    const WristStream& stream = sensors_[arm]->stream();
    // Only a new sample has a new time: both clocks run unevenly, and a difference of theirs would
    // make an old sample look new.
    if (fresh || !told_[arm]) {
      const double taken_s = reading->time_s - (steady_s() - stream.time_s());
      sample_time_s_[arm] = told_[arm] ? std::max(sample_time_s_[arm], taken_s) : taken_s;
      told_[arm] = true;
    }
    reading->arms[arm].wrench_in_tool = stream.in_tool();
    reading->arms[arm].wrench_time_s = sample_time_s_[arm];
  }
  resting_ = false;
  return reading;
}

void WristRobot::apply(const robot::RobotCommand& command) noexcept {
  arms_.apply(command);
}

}  // namespace tuina::hardware
