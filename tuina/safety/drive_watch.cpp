// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/drive_watch.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::safety {
namespace {

// What is learnt is known after fifty milliseconds to a tenth: one sample tells mostly of its
// noise.
constexpr double smoothed_ticks = 5.0, known_after_ticks = 50.0, learnt_ticks = 1000.0;
// Currents and the constants of motors are known to some per cent, amplifiers have an offset. Once
// these are known, noise is left: smoothed, 0.8 % of what a drive can give stay within this.
constexpr double scale_share = 0.1, offset_share = 0.015, noise_share = 0.012;
// What is two milliseconds late differs by as much of a change of the command that is smoothed.
constexpr double late_share = 0.5;
// In one millisecond a difference counts as thrice the allowed at the most, so that two of them
// are nothing yet.
constexpr double max_beyond = 2.0;
constexpr double borne = 4.0;

}  // namespace

void DriveWatch::compare(const JointVector& measured_nm, const JointVector& commanded_nm,
                         bool begins) noexcept {
  if (measured_nm.size() != limit_nm_.size() || commanded_nm.size() != limit_nm_.size()) return;
  if (beyond_.size() == 0) {
    beyond_ = JointVector::Zero(limit_nm_.size());
    known_at_nm_ = commanded_nm;
    known_nm_ = JointVector::Zero(limit_nm_.size());
    begins = true;
  }
  if (begins) {
    commanded_nm_ = commanded_nm;
    measured_nm_ = commanded_nm + known_nm_;
  }
  known_ticks_ = std::min(known_ticks_ + 1.0, learnt_ticks);
  for (Eigen::Index i = 0; i < limit_nm_.size(); ++i) {
    const bool number = std::isfinite(measured_nm[i]);
    if (number) measured_nm_[i] += (measured_nm[i] - measured_nm_[i]) / smoothed_ticks;
    const double change_nm = commanded_nm[i] - commanded_nm_[i];
    commanded_nm_[i] += change_nm / smoothed_ticks;
    const double off_nm = measured_nm_[i] - commanded_nm_[i];
    const double late_nm = late_share * std::abs(change_nm);
    const double max_nm = scale_share * std::abs(commanded_nm_[i]) + offset_share * limit_nm_[i];
    const double max_news_nm =
        scale_share * std::abs(commanded_nm_[i] - known_at_nm_[i]) + noise_share * limit_nm_[i];
    double share = std::abs(off_nm) / (max_nm + late_nm);
    if (known_ticks_ > known_after_ticks)
      share = std::max(share, std::abs(off_nm - known_nm_[i]) / (max_news_nm + late_nm));
    const double beyond = number ? std::min(share - 1.0, max_beyond) : max_beyond;
    beyond_[i] = std::max(0.0, beyond_[i] + beyond);
    if (beyond_[i] > 0.0) continue;  // what is amiss is not learnt
    known_nm_[i] += (off_nm - known_nm_[i]) / known_ticks_;
    known_at_nm_[i] += (commanded_nm_[i] - known_at_nm_[i]) / known_ticks_;
  }
  Eigen::Index worst = 0;
  misfit_ = beyond_.maxCoeff(&worst) / borne;
  reversed_joint_ = measured_nm_[worst] * commanded_nm_[worst] < 0.0 ? static_cast<int>(worst) : -1;
}

}  // namespace tuina::safety
