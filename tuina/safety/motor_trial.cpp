// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/motor_trial.hpp"

namespace tuina::safety {
namespace {

// Torques fall by 10 Nm a millisecond, and speeds tell of them two milliseconds later.
constexpr int settling_ticks = 4, judged_ticks = 6;
constexpr double remembered_ticks = 10.0;
// Of a motor that turns the other way twice its torque is missing, of a dead one all of it;
// friction adds to that or hides some. Where more is missing somebody pushes.
constexpr double min_missing_share = 1.3, max_missing_share = 3.0;
constexpr double stopped_share = 0.4;

}  // namespace

void MotorTrial::look(const JointVector& unexplained_nm, const JointVector& applied_nm,
                      int suspect) noexcept {
  if (unexplained_nm.size() != applied_nm.size()) return;
  if (tried_.size() == 0) tried_ = missing_nm_ = told_nm_ = JointVector::Zero(applied_nm.size());
  if (joint_ < 0) {
    missing_nm_ += (unexplained_nm - missing_nm_) / remembered_ticks;
    told_nm_ += (applied_nm - told_nm_) / remembered_ticks;
    if (suspect < 0 || tried_[suspect] > 0.0) return;
    const double share = missing_nm_[suspect] / told_nm_[suspect];  // no number where none is told
    if (!(share > min_missing_share && share < max_missing_share)) return;
    joint_ = suspect;
    tried_[joint_] = 1.0;
    left_share_ = 0.0;
    ticks_ = 0;
    return;
  }
  if (ticks_ == settling_ticks + judged_ticks) return;
  if (++ticks_ > settling_ticks)
    left_share_ += unexplained_nm[joint_] / missing_nm_[joint_] / judged_ticks;
  if (ticks_ == settling_ticks + judged_ticks && left_share_ > stopped_share) joint_ = -1;
}

}  // namespace tuina::safety
