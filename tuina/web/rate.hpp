// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace tuina::web {

/// So many at once, and so many a second after that.
class Rate {
 public:
  /// With all of `at_once` left.
  Rate(double at_once, double per_s) : at_once_(at_once), per_s_(per_s), left_(at_once) {}

  /// Whether one more is within the rate at `now_s`; it then counts.
  [[nodiscard]] bool take(double now_s) noexcept {
    left_ = std::min(at_once_, left_ + per_s_ * std::max(0.0, now_s - last_s_));
    last_s_ = now_s;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }
  /// What was taken last does not count after all.
  void give_back() noexcept { left_ = std::min(at_once_, left_ + 1.0); }

 private:
  double at_once_, per_s_, left_;
  double last_s_ = 0.0;
};

}  // namespace tuina::web
