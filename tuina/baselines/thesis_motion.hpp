// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/motion_profile.hpp"

namespace tuina::baselines {

/// The online trajectory generator of [thesis] (3.10)-(3.13), for one axis: a baseline to compare
/// `MotionProfile` with. Three phases by clamping a speed: it may grow by the acceleration times
/// the sample time, not beyond its limit, and not beyond what stops at the goal.
///
/// Its faults, each shown in tests/control/thesis_motion_test.cpp: the acceleration jumps, so the
/// jerk has no bound; printed for positive speeds only, it is mirrored here for the others; a goal
/// moved behind the axis is met with a speed that jumps to nothing; and fed with the MEASURED
/// state, as Fig. 3-4 draws it, it deadlocks on stiction: it leads by less than what overcomes
/// friction.
class ThesisMotion {
 public:
  enum class Feeds : std::uint8_t { planned, measured };  ///< which state each step starts from

  struct Limits {
    double speed_per_s = 0.0;
    double acceleration_per_s2 = 0.0;
  };

  void start(double at) noexcept { planned_ = {.at = at}; }

  /// The state of the next tick. `measured` is used with Feeds::measured only. Numbers that are not
  /// finite leave the plan where it is, at rest.
  control::MotionState step(const control::MotionState& measured, double goal, const Limits& limits,
                            double dt_s, Feeds feeds = Feeds::planned) noexcept;

  [[nodiscard]] const control::MotionState& planned() const noexcept { return planned_; }

 private:
  control::MotionState planned_;
};

}  // namespace tuina::baselines
