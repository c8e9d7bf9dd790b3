// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::sim {

/// What may go wrong between the devices of a robot and whoever commands them.
enum class RobotFault : std::uint8_t {
  wrench_dropout,     ///< the old sample with its old stamp
  wrench_stuck,       ///< the old sample with fresh stamps
  wrench_nan,         ///< no number
  wrench_spikes,      ///< one sample off by `size` N, `rate_hz` times a second
  wrench_bias,        ///< `size` N more
  wrench_drift,       ///< `size` N more every second
  wrench_flip,        ///< one axis reversed
  wrench_saturation,  ///< nothing beyond `size` N
  encoder_frozen,     ///< the old angle, no speed
  encoder_jump,       ///< `size` rad more; the speed does not show it
  encoder_nan,
  motor_gain,        ///< `size` times the torque, by a current as it is commanded
  drive_gain,        ///< `size` times current and torque: 0 is a dead joint, -1 a reversed one
  drive_noise,       ///< a deviation of `size` Nm in every joint
  drives_fade,       ///< likewise, every joint, and down to `size` in a second
  clock_stopped,     ///< time and stamps stand still, ticks go on
  clock_jump,        ///< time and stamps `size` s later
  stall,             ///< nobody runs: the next reading is the one after `duration_s`
  readings_lost,     ///< no reading, the world goes on
  readings_doubled,  ///< every second reading is the one before it
  commands_lost,     ///< nothing is applied any more
};

struct TimedFault {
  RobotFault kind = RobotFault::wrench_dropout;
  Arm arm = Arm::left;
  int part = 0;  ///< joint of the arm, or axis of the wrist sensor: 0 is the tool's shaft
  double size = 0.0;
  double onset_s = 0.0;  ///< in true time
  double duration_s = std::numeric_limits<double>::infinity();
  double rate_hz = 1.0;
};

/// A robot whose readings and commands go wrong as a schedule says; all else is the robot behind
/// it. The truth of a simulation stays where it was. It is in this room so that nothing which
/// drives a real robot can reach it: rooms of the product may not include `sim`, which the
/// `layering` test holds. No heap in `read` and `apply`.
class FaultyRobot final : public robot::Robot {
 public:
  /// `robot` must outlive it. `seed` is that of the noise.
  explicit FaultyRobot(robot::Robot& robot, std::uint64_t seed = 1);

  void add(const TimedFault& fault);
  /// True time of the last reading of the robot behind it.
  [[nodiscard]] double time_s() const noexcept { return time_s_; }

  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override {
    return robot_.stand_ready(pose);
  }
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override { return robot_.fault(); }

 private:
  struct Running {
    TimedFault fault;
    bool begun = false;
    robot::RobotReading first;  // in which the fault began
    double last_spike = -1.0;
    double hidden_nm = 0.0;  // lost behind the current that the drive measures
  };
  [[nodiscard]] bool acts(const Running& running) const noexcept;
  void spoil(Running& running, robot::RobotReading& reading) noexcept;
  void spoil_arm(Running& running, robot::ArmReading& arm) noexcept;

  robot::Robot& robot_;
  std::vector<Running> faults_;
  Random random_;
  double time_s_ = 0.0;
  robot::RobotReading before_;  // the last one given
  bool doubled_ = false;
};

}  // namespace tuina::sim
