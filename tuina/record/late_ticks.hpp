// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "tuina/core/stopwatch.hpp"
#include "tuina/session/observer.hpp"

namespace tuina::record {

/// How late the milliseconds of a massage were over, by the clock of this machine.
struct Lateness {
  std::uint64_t ticks = 0;
  double median_s = 0.0, p999_s = 0.0, max_s = 0.0;  ///< half and 999 of 1000 were no later
};

/// How late each millisecond was over, its torques sent, at a pace that the clock sets. The
/// quickest one is the measure: it was not late. Memory is taken at once.
class LateTicks final : public session::Observer {
 public:
  /// Milliseconds of the robot in one of the clock.
  explicit LateTicks(double pace) : pace_(pace) {}
  /// Time that a scan or a plan took is no lateness.
  void on_plan(const motion::ReadyPlan&, const Transform&) override { begins_.reset(); }
  void on_tick(const session::Tick& tick) noexcept override {
    note(watch_.seconds(), tick.reading.time_s);
  }
  /// The millisecond `time_s` of the robot was over at `clock_s`.
  void note(double clock_s, double time_s) noexcept;
  /// To 0.01 ms up to 0.1 s, the largest exactly.
  [[nodiscard]] Lateness found() const noexcept;

 private:
  [[nodiscard]] double at_share_s(double share) const noexcept;

  static constexpr double step_s = 1e-5, max_told_s = 0.1;
  double pace_;
  Stopwatch watch_;
  std::optional<double> begins_;  ///< when the robot's time was zero, by the clock
  std::array<std::uint32_t, 10000> counts_ = {};
  std::uint64_t ticks_ = 0;
  double max_s_ = 0.0;
};

}  // namespace tuina::record
