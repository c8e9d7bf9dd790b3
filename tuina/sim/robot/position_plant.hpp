// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/position_drives.hpp"

namespace tuina::sim {

/// The maker's controller of a position-controlled arm. It takes a place in each of its cycles,
/// obeys it one cycle later, and goes there evenly within the cycle after; a critically damped
/// filter makes it as slow as `bandwidth_hz` says, and a stiff loop holds the joints to that.
struct PositionLoop {
  double cycle_hz = 500.0;     ///< 125 or 500: a divisor of 1000
  double bandwidth_hz = 20.0;  ///< at which a joint does 0.7 of what it is told

  /// By which the arm follows a steady motion: two cycles, and the filter's.
  [[nodiscard]] double lag_s() const noexcept;
  [[nodiscard]] bool operator==(const PositionLoop&) const = default;
};

/// What newer and older arms of that kind do, by no measurement.
inline constexpr PositionLoop quick_loop = {.cycle_hz = 500.0, .bandwidth_hz = 20.0},
                              slow_loop = {.cycle_hz = 125.0, .bandwidth_hz = 10.0};

/// A simulated robot behind such a controller, which knows its arms as their table does. The
/// robot's encoders must be exact and its gears rigid: they are within the maker's loop. No heap in
/// `read` and `follow`.
class PositionPlant final : public robot::PositionDrives {
 public:
  /// `torques` must outlive it.
  PositionPlant(robot::Robot& torques, const PerArm<robot::ArmModel>& models,
                const PositionLoop& loop) noexcept;

  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  [[nodiscard]] const PerArm<JointVector>* driven_nm() const noexcept override {
    return &driven_nm_;
  }
  void follow(const robot::PlaceCommand& command) noexcept override { newest_ = command; }
  [[nodiscard]] const char* fault() const noexcept override { return torques_.fault(); }

 private:
  struct Side {
    explicit Side(const robot::ArmModel& of) noexcept : model(of) {}
    robot::ArmModel model;
    JointVector from_rad, to_rad, next_rad;    ///< places of three cycles
    JointVector wanted_rad, wanted_rad_per_s;  ///< after the filter
    JointVector told_rad, told_rad_per_s;      ///< of the newest cycle
    JointVector lasting;                       ///< integral of what the loop is off by
  };
  void begin(const robot::RobotReading& reading) noexcept;
  [[nodiscard]] JointVector drive(Side& side, const robot::ArmReading& reading, double share,
                                  double rail_m) noexcept;

  robot::Robot& torques_;
  PerArm<Side> sides_;
  int cycle_ticks_, ticks_ = 0;
  double filter_per_s_;
  bool started_ = false;
  robot::PlaceCommand newest_;
  PerArm<JointVector> driven_nm_;
};

}  // namespace tuina::sim
