// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/core/arm.hpp"

namespace tuina::control {

/// State of one axis, in metres or radians and seconds.
struct MotionState {
  double at = 0.0;
  double speed_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
};

/// Largest speed, acceleration and jerk of an axis, in metres or radians.
struct MotionLimits {
  double speed_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
  double jerk_per_s3 = 0.0;
};

/// Time-optimal jerk-limited motion of one axis from any state to rest at a goal. Replanning from
/// `at(time_s)` is possible at any tick; a start beyond the limits first returns into them.
class MotionProfile {
 public:
  /// At rest at zero.
  MotionProfile() = default;

  /// False for non-finite numbers or non-positive limits; the old motion stays.
  [[nodiscard]] bool plan(const MotionState& start, double goal,
                          const MotionLimits& limits) noexcept;

  /// Stretches the motion to `duration_s`; a time below the optimum gives the optimum.
  [[nodiscard]] bool plan_in(double duration_s, const MotionState& start, double goal,
                             const MotionLimits& limits) noexcept;

  /// Comes to rest as soon as it can, wherever that is. False as in `plan`.
  [[nodiscard]] bool plan_stop(const MotionState& start, const MotionLimits& limits) noexcept;

  /// State at a time since the plan; at rest at the goal after `duration_s`.
  [[nodiscard]] MotionState at(double time_s) const noexcept;
  [[nodiscard]] double duration_s() const noexcept { return duration_s_; }
  /// Where it comes to rest, m or rad.
  [[nodiscard]] double goal() const noexcept { return goal_; }

  /// A phase of constant jerk.
  struct Stretch {
    double duration_s = 0.0;
    double jerk_per_s3 = 0.0;
  };

 private:
  MotionState start_;
  double goal_ = 0.0;
  double duration_s_ = 0.0;
  std::array<Stretch, 7> stretches_ = {};  // three to accelerate, one to cruise, three to brake
};

}  // namespace tuina::control
