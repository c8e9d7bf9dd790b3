// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/position_delay.hpp"

#include <algorithm>

namespace tuina::tissue {

void PositionDelay::keep(double time_s, double position_m) noexcept {
  const std::size_t n = kept_.size(), newest = (next_ + n - 1) % n, before = (next_ + n - 2) % n;
  if (size_ >= 2 && time_s - kept_[before].time_s < keep_every_s) {
    kept_[newest] = {time_s, position_m};
    return;
  }
  kept_[next_] = {time_s, position_m};
  next_ = (next_ + 1) % n;
  size_ = std::min(size_ + 1, n);
}

double PositionDelay::at(double time_s) const noexcept {
  const std::size_t n = kept_.size();
  std::size_t newer = (next_ + n - 1) % n;
  for (std::size_t i = 1; i < size_; ++i) {
    const std::size_t older = (newer + n - 1) % n;
    const Timed& a = kept_[older];
    const Timed& b = kept_[newer];
    if (a.time_s <= time_s) {
      const double share = std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
      return a.position_m + share * (b.position_m - a.position_m);
    }
    newer = older;
  }
  return kept_[newer].position_m;
}

}  // namespace tuina::tissue
