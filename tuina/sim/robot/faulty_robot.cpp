// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/faulty_robot.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::sim {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
constexpr double rounding_s = 1e-9;  // of times that are whole milliseconds

}  // namespace

FaultyRobot::FaultyRobot(robot::Robot& robot, std::uint64_t seed)
    : robot_(robot), random_(make_random(seed, "faulty drives")) {}

void FaultyRobot::add(const TimedFault& fault) {
  faults_.push_back({.fault = fault, .first = {}});
}

bool FaultyRobot::acts(const Running& running) const noexcept {
  const double since_s = time_s_ - running.fault.onset_s + rounding_s;
  return since_s >= 0.0 && since_s < running.fault.duration_s;
}

std::optional<robot::RobotReading> FaultyRobot::read() noexcept {
  std::optional<robot::RobotReading> reading = robot_.read();
  if (!reading) return reading;
  time_s_ = reading->time_s;
  for (Running& running : faults_) {
    if (running.fault.kind != RobotFault::stall || running.begun || !acts(running)) continue;
    running.begun = true;
    while (acts(running)) {
      reading = robot_.read();
      if (!reading) return reading;
      time_s_ = reading->time_s;
    }
  }
  bool lost = false, doubles = false;
  for (Running& running : faults_) {
    if (!acts(running)) continue;
    lost = lost || running.fault.kind == RobotFault::readings_lost;
    doubles = doubles || running.fault.kind == RobotFault::readings_doubled;
    spoil(running, *reading);
  }
  if (lost) return std::nullopt;
  doubled_ = doubles && !doubled_;
  if (doubled_) return before_;
  before_ = *reading;
  return reading;
}

void FaultyRobot::spoil(Running& running, robot::RobotReading& reading) noexcept {
  if (!running.begun) running.first = reading;
  running.begun = true;
  const TimedFault& fault = running.fault;
  double shift_s = 0.0;
  if (fault.kind == RobotFault::clock_jump) shift_s = fault.size;
  if (fault.kind == RobotFault::clock_stopped) shift_s = running.first.time_s - reading.time_s;
  reading.time_s += shift_s;
  for (robot::ArmReading& arm : reading.arms.of) arm.wrench_time_s += shift_s;
  spoil_arm(running, reading.arms[fault.arm]);
}

void FaultyRobot::spoil_arm(Running& running, robot::ArmReading& arm) noexcept {
  const TimedFault& fault = running.fault;
  const robot::ArmReading& first = running.first.arms[fault.arm];
  Vector3& force_n = arm.wrench_in_tool.force_n;
  const double since_s = time_s_ - fault.onset_s;
  switch (fault.kind) {
    case RobotFault::wrench_dropout:
      arm.wrench_in_tool = first.wrench_in_tool;
      arm.wrench_time_s = first.wrench_time_s;
      return;
    case RobotFault::wrench_stuck:
      arm.wrench_in_tool = first.wrench_in_tool;
      return;
    case RobotFault::wrench_nan:
      force_n[fault.part] = no_number;
      return;
    case RobotFault::wrench_spikes: {
      const double spike = std::floor((since_s + rounding_s) * fault.rate_hz);
      if (spike > running.last_spike) force_n[fault.part] += fault.size;
      running.last_spike = spike;
      return;
    }
    case RobotFault::wrench_bias:
      force_n[fault.part] += fault.size;
      return;
    case RobotFault::wrench_drift:
      force_n[fault.part] += fault.size * since_s;
      return;
    case RobotFault::wrench_flip:
      force_n[fault.part] = -force_n[fault.part];
      return;
    case RobotFault::wrench_saturation:
      force_n = force_n.cwiseMin(fault.size).cwiseMax(-fault.size);
      return;
    case RobotFault::encoder_frozen:
      arm.q_rad[fault.part] = first.q_rad[fault.part];
      arm.dq_rad_per_s[fault.part] = 0.0;
      return;
    case RobotFault::encoder_jump:
      arm.q_rad[fault.part] += fault.size;
      return;
    case RobotFault::encoder_nan:
      arm.q_rad[fault.part] = arm.dq_rad_per_s[fault.part] = no_number;
      return;
    case RobotFault::motor_gain:
      if (fault.part < arm.measured_torque_nm.size())
        arm.measured_torque_nm[fault.part] += running.hidden_nm;
      return;
    default:
      return;
  }
}

void FaultyRobot::apply(const robot::RobotCommand& command) noexcept {
  robot::RobotCommand given = command;
  for (Running& running : faults_) {
    const TimedFault& fault = running.fault;
    if (!acts(running)) continue;
    JointVector& torque_nm = given.torque_nm[fault.arm];
    if (fault.kind == RobotFault::commands_lost) return;
    const bool of_joint =
        fault.kind == RobotFault::drive_gain || fault.kind == RobotFault::motor_gain;
    if (of_joint && fault.part < torque_nm.size()) {
      const double whole_nm = torque_nm[fault.part];
      torque_nm[fault.part] *= fault.size;
      running.hidden_nm = whole_nm - torque_nm[fault.part];
    }
    if (fault.kind == RobotFault::drives_fade)
      torque_nm *= 1.0 - (1.0 - fault.size) * std::clamp(time_s_ - fault.onset_s, 0.0, 1.0);
    if (fault.kind != RobotFault::drive_noise) continue;
    for (Eigen::Index i = 0; i < torque_nm.size(); ++i)
      torque_nm[i] += gaussian(random_, fault.size);
  }
  robot_.apply(given);
}

}  // namespace tuina::sim
