// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/late_ticks.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::record {

void LateTicks::note(double clock_s, double time_s) noexcept {
  const double begins_s = clock_s - time_s / pace_;
  begins_ = std::min(begins_.value_or(begins_s), begins_s);
  const double late_s = begins_s - *begins_;
  ++ticks_;
  max_s_ = std::max(max_s_, late_s);
  // What is so far behind is not caught up with: the simulated robot's time goes on from there.
  if (late_s >= max_told_s) {
    begins_ = begins_s;
    return;
  }
  ++counts_[std::min(static_cast<std::size_t>(late_s / step_s), counts_.size() - 1)];
}

double LateTicks::at_share_s(double share) const noexcept {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(ticks_)));
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    sum += counts_[i];
    if (sum >= wanted) return std::min(step_s * static_cast<double>(i + 1), max_s_);
  }
  return max_s_;
}

Lateness LateTicks::found() const noexcept {
  if (ticks_ == 0) return {};
  return {
      .ticks = ticks_, .median_s = at_share_s(0.5), .p999_s = at_share_s(0.999), .max_s = max_s_};
}

}  // namespace tuina::record
