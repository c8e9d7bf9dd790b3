// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/position_plant.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::sim {
namespace {

// The loop that holds the joints: 40 Hz, critically damped, an integral for what lasts.
constexpr double held_per_s = 250.0, lasting_per_s = 20.0;
// A critically damped filter of w halves the power at 0.6436 w.
constexpr double half_power = 0.6436;

double filter_of(double bandwidth_hz) {
  return 2.0 * pi * bandwidth_hz / half_power;
}

}  // namespace

double PositionLoop::lag_s() const noexcept {
  return 2.0 / cycle_hz + 2.0 / filter_of(bandwidth_hz);
}

PositionPlant::PositionPlant(robot::Robot& torques, const PerArm<robot::ArmModel>& models,
                             const PositionLoop& loop) noexcept
    : torques_(torques),
      sides_{{Side(models[Arm::left]), Side(models[Arm::right])}},
      cycle_ticks_(
          std::max(1, static_cast<int>(std::lround(1.0 / (loop.cycle_hz * control_period_s))))),
      filter_per_s_(filter_of(loop.bandwidth_hz)) {}

Result<void> PositionPlant::stand_ready(const robot::ReadyPose& pose) {
  started_ = false;
  return torques_.stand_ready(pose);
}

void PositionPlant::begin(const robot::RobotReading& reading) noexcept {
  started_ = true;
  ticks_ = 0;
  newest_.rail_m = reading.rail_m;
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    const JointVector& q_rad = reading.arms[arm].q_rad;
    newest_.q_rad[arm] = q_rad;
    side.from_rad = side.to_rad = side.next_rad = side.wanted_rad = side.told_rad = q_rad;
    side.wanted_rad_per_s = side.told_rad_per_s = side.lasting = JointVector::Zero(q_rad.size());
  }
}

JointVector PositionPlant::drive(Side& side, const robot::ArmReading& reading, double share,
                                 double rail_m) noexcept {
  const JointVector goal_rad = side.from_rad + share * (side.to_rad - side.from_rad);
  const JointVector acceleration = filter_per_s_ * filter_per_s_ * (goal_rad - side.wanted_rad) -
                                   2.0 * filter_per_s_ * side.wanted_rad_per_s;
  side.wanted_rad_per_s += control_period_s * acceleration;
  side.wanted_rad += control_period_s * side.wanted_rad_per_s;
  const JointVector off_rad = side.wanted_rad - reading.q_rad;
  side.lasting += lasting_per_s * control_period_s * off_rad;
  const robot::ArmDynamics dynamics =
      side.model.evaluate(reading.q_rad, reading.dq_rad_per_s, rail_m);
  return dynamics.mass_kg_m2 *
             (acceleration + 2.0 * held_per_s * (side.wanted_rad_per_s - reading.dq_rad_per_s) +
              held_per_s * held_per_s * (off_rad + side.lasting)) +
         dynamics.coriolis_nm + dynamics.gravity_nm;
}

std::optional<robot::RobotReading> PositionPlant::read() noexcept {
  auto reading = torques_.read();
  if (!reading) return reading;
  if (!started_) begin(*reading);
  const int within = ticks_++ % cycle_ticks_;
  robot::RobotCommand command{.rail_m = newest_.rail_m};
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    robot::ArmReading& seen = reading->arms[arm];
    if (within == 0) {
      side.from_rad = side.to_rad;
      side.to_rad = side.next_rad;
      side.next_rad = newest_.q_rad[arm];
      side.told_rad = seen.q_rad;
      side.told_rad_per_s = seen.dq_rad_per_s;
    }
    const double share = static_cast<double>(within + 1) / cycle_ticks_;
    command.torque_nm[arm] = drive(side, seen, share, reading->rail_m);
    seen.q_rad = side.told_rad;
    seen.dq_rad_per_s = side.told_rad_per_s;
  }
  driven_nm_ = command.torque_nm;
  torques_.apply(command);
  return reading;
}

}  // namespace tuina::sim
