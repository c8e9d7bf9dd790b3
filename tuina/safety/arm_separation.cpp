// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/arm_separation.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/robot/clearance.hpp"

namespace tuina::safety {

bool ArmSeparation::keeps(const robot::RobotReading& reading) noexcept {
  PerArm<robot::ArmModel::Kinematics> now;
  for (const Arm arm : both_arms) {
    const JointVector& q_rad = reading.arms[arm].q_rad;
    // Nobody knows where such an arm is, so nothing keeps clear of it.
    if (q_rad.size() != models_[arm].joints() || !q_rad.allFinite() ||
        !std::isfinite(reading.rail_m))
      return arms_keep_ = false;
    now[arm] = models_[arm].kinematics(reading.arms[arm].q_rad, reading.rail_m);
  }
  const auto between_m = [&](const robot::ArmModel::Kinematics& left,
                             const robot::ArmModel::Kinematics& right) {
    return robot::distance_between_m(models_[Arm::left], left, models_[Arm::right], right);
  };
  apart_m_ = between_m(now[Arm::left], now[Arm::right]);
  PerArm<double> clear_m;
  for (const Arm arm : both_arms) {
    clear_m[arm] = robot::clearances(models_[arm], now[arm], reading.rail_m, obstacles_).min_m();
  }
  if (watching_) {
    const double ticks = std::max(static_cast<double>(reading.tick - tick_), 1.0);
    const double passed_s = ticks * control_period_s;
    const double smoothing = passed_s / (passed_s + 20e-3);  // encoders are coarse
    const PerArm<double> had_it_stayed_m = {.of = {between_m(before_[Arm::left], now[Arm::right]),
                                                   between_m(now[Arm::left], before_[Arm::right])}};
    for (const Arm arm : both_arms) {
      const double closing = (had_it_stayed_m[arm] - apart_m_) / passed_s;
      closing_m_per_s_[arm] += smoothing * (closing - closing_m_per_s_[arm]);
      if (obstacles_.empty()) continue;
      const double nearing = (clear_m_[arm] - clear_m[arm]) / passed_s;
      nearing_m_per_s_[arm] += smoothing * (nearing - nearing_m_per_s_[arm]);
    }
  }
  watching_ = true;
  tick_ = reading.tick;
  before_ = now;
  clear_m_ = clear_m;
  // Each arm brakes by itself, so each share of the closing speed has its own braking distance.
  const auto way_m = [](double closing) {
    const double speed_m_per_s = std::max(closing, 0.0);
    return speed_m_per_s * speed_m_per_s / (2.0 * halting_m_per_s2);
  };
  double halted_m = apart_m_;
  bool clear = true;
  for (const Arm arm : both_arms) {
    halted_m -= way_m(closing_m_per_s_[arm]);
    clear = clear && clear_m[arm] - way_m(nearing_m_per_s_[arm]) >= stopping_arm_distance_m;
  }
  arms_keep_ = halted_m >= stopping_arm_distance_m;
  return arms_keep_ && clear;
}

}  // namespace tuina::safety
