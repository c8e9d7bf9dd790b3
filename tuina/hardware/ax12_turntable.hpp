// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tuina/hardware/yaw_servo.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::hardware {

/// The unit of the scanner on an AX-12A. A thread of its own asks the motor a hundred times a
/// second and keeps the laser lit, but only while the scan goes on asking `arrived`: who hangs
/// leaves no laser lit. Readings are on the host's steady clock, as V4L2's time stamps are.
///
/// A sweep begins 3 degrees before its first angle and goes on for 2 degrees after its last one,
/// so that the play of the gear is taken up and the speed even between them.
class Ax12Turntable final : public scanner::Turntable {
 public:
  /// Fails with Fault::device, naming the line and what mends it.
  [[nodiscard]] static Result<std::unique_ptr<Ax12Turntable>> open(const TurntableDevice& device);
  /// The laser goes out.
  ~Ax12Turntable() override;

  /// Returns once the unit turns evenly, some degrees before `from_rad`. The motor knows speeds of
  /// whole multiples of 0.666 degrees per second. Fails when an angle is beyond the motor's, or
  /// the unit does not come to where it begins.
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  /// Takes a step every 0.1 s, of at least one count of the motor (0.29 degrees).
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override;
  [[nodiscard]] Result<void> switch_laser(bool on) override;
  [[nodiscard]] Result<std::vector<scanner::YawReading>> readings() const override;
  /// Which board and motor answered, and where the motor stood when it was opened, for people.
  [[nodiscard]] std::string who() const;

 private:
  using Clock = SerialPort::Clock;
  Ax12Turntable(YawServo servo, int count);
  [[nodiscard]] Result<void> begin_at(double yaw_rad);
  [[nodiscard]] Result<int> count_of(double yaw_rad) const;
  [[nodiscard]] double yaw_of(int count) const;
  [[nodiscard]] Result<void> standing() const;
  void run(const std::stop_token& stop);
  void look();
  void judge(const YawServo::Told& told);
  void take_step();

  mutable std::mutex mutex_;  // guards all below
  YawServo servo_;
  int opened_at_count_;
  std::optional<Error> failure_;
  Clock::time_point last_told_at_;
  bool want_lit_ = false;
  mutable Clock::time_point asked_at_;  // when the scan last asked whether the unit has arrived
  bool turning_ = false;
  bool turned_ = false;  // has arrived
  int count_ = 0;
  int goal_count_ = 0;   // where the motor goes
  int end_count_ = 0;    // where the turn ends
  int direction_ = 1;    // of the counts
  int step_counts_ = 0;  // 0: a sweep
  Clock::time_point next_step_at_;
  int stands_at_count_ = 0;  // since the time below
  Clock::time_point stands_since_;
  Clock::duration max_stand_ = {};
  std::vector<YawServo::Told> told_;  // of this turn
  std::jthread thread_;               // the last member: it ends first
};

}  // namespace tuina::hardware
