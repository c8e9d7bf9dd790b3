// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/arm_distances.hpp"

#include <algorithm>

#include "tuina/robot/clearance.hpp"

namespace tuina::app {

telemetry::ArmDistance* ArmDistances::add(double time_s, const Poses& poses, double rail_m) {
  const double apart_m = robot::distance_between_m(models_[Arm::left], poses[Arm::left],
                                                   models_[Arm::right], poses[Arm::right]);
  min_apart_m_ = std::min(min_apart_m_, apart_m);
  robot::Clearances clear;
  for (const Arm arm : both_arms)
    clear.take_least(robot::clearances(models_[arm], poses[arm], rail_m, obstacles_));
  clear_.take_least(clear);
  constexpr double rows_every_s = 0.1;
  if (!rows_.empty() && time_s - rows_.back().time_s < rows_every_s - 1e-6) return nullptr;
  rows_.push_back({.time_s = time_s,
                   .apart_m = apart_m,
                   .to_couch_m = clear[robot::Surrounding::couch],
                   .to_body_m = clear[robot::Surrounding::body]});
  return &rows_.back();
}

}  // namespace tuina::app
