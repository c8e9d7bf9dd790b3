// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/thesis_motion.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::baselines {

using namespace control;

MotionState ThesisMotion::step(const MotionState& measured, double goal, const Limits& limits,
                               double dt_s, Feeds feeds) noexcept {
  const MotionState last = feeds == Feeds::measured ? measured : planned_;
  const bool usable = std::isfinite(last.at) && std::isfinite(last.speed_per_s) &&
                      std::isfinite(goal) && limits.speed_per_s > 0.0 &&
                      limits.acceleration_per_s2 > 0.0 && dt_s > 0.0;
  if (!usable) {
    planned_ = {.at = planned_.at};
    return planned_;
  }
  const double left = goal - last.at;
  const double side = left >= 0.0 ? 1.0 : -1.0;
  const double S = std::abs(left);
  const double before = std::max(side * last.speed_per_s, 0.0);
  // (3.10), (3.11), (3.12): x' may not exceed any of the three.
  const double speed = std::min({before + limits.acceleration_per_s2 * dt_s, limits.speed_per_s,
                                 std::sqrt(2.0 * limits.acceleration_per_s2 * S)});
  // (3.13), which may not step over the goal.
  const double way = std::min(0.5 * (speed + before) * dt_s, S);
  const bool arrives = way >= S;
  planned_ = {.at = arrives ? goal : last.at + side * way,
              .speed_per_s = arrives ? 0.0 : side * speed,
              .acceleration_per_s2 = side * (speed - before) / dt_s};
  return planned_;
}

}  // namespace tuina::baselines
