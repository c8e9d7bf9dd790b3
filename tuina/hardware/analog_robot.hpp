// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "tuina/hardware/dac_encoder.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::hardware {

/// One joint on the card. Signs say which way it turns.
struct AnalogJoint {
  /// Volts for a newton metre at the joint: amplifier's volts per ampere / (torque constant x
  /// gear).
  double volts_per_nm = 0.0;
  double counts_per_rad = 0.0;  ///< of the joint
  std::int64_t zero_count = 0;  ///< where the joint is at 0
};

/// A robot of amplifiers with an analog input, on a card. Its host has the clock. Amplifiers hold
/// no place by themselves, so the arms are brought to where they stand ready by springs and dampers
/// of this class, and stand there on their brakes until the first command. They feel no contact, as
/// those of `Cia402Robot`, and have no linear base.
class AnalogRobot final : public robot::Robot {
 public:
  /// What times a millisecond: the host's steady clock, or each `read` of a simulated card.
  enum class Clock : std::uint8_t { host, card };

  /// The card must outlive this. Fails with Fault::config where the joints are not those of the
  /// table, one needs more than 10 V for the table's torque, or the table's base has a way to go.
  [[nodiscard]] static Result<std::unique_ptr<AnalogRobot>> open(
      DacEncoder& card, const PerArm<std::vector<AnalogJoint>>& joints,
      const robot::ArmTable& table, const robot::RobotMount& mount, Clock clock = Clock::host);
  /// The brakes close.
  ~AnalogRobot() override;

  /// The farthest joint by 15 degrees a second.
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override { return fault_; }

 private:
  AnalogRobot(DacEncoder& card, const PerArm<std::vector<AnalogJoint>>& joints,
              const robot::ArmTable& table, const robot::RobotMount& mount, Clock clock);
  [[nodiscard]] std::int64_t wait_for_cycle() noexcept;
  [[nodiscard]] robot::RobotCommand spring_to(const PerArm<JointVector>& q_rad) const noexcept;
  [[nodiscard]] Result<void> move_to(const PerArm<JointVector>& q_rad);
  void brake() noexcept;

  DacEncoder& card_;
  PerArm<std::vector<AnalogJoint>> joints_;
  PerArm<robot::ArmModel> models_;
  std::array<double, both_arms.size()* max_joints> volts_ = {};
  std::array<std::int64_t, both_arms.size()* max_joints> counts_ = {};
  std::size_t channels_ = 0;
  robot::RobotReading now_;
  Clock clock_;
  std::optional<std::chrono::steady_clock::time_point> next_;  ///< when the next millisecond begins
  int unread_in_row_ = 0;
  bool standing_ = false;
  const char* fault_ = nullptr;
};

}  // namespace tuina::hardware
