// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace tuina::safety {

/// How far a value rose and fell within its last 16 changes. Real-time: no heap, no exceptions.
class Swing {
 public:
  /// Greatest rise and greatest fall from an earlier value to a later one; both positive.
  struct Extent {
    double raised = 0.0, lowered = 0.0;
    /// Way that was made in both directions: nothing where the value only rose or only fell.
    [[nodiscard]] double to_and_fro() const noexcept { return std::min(raised, lowered); }
  };

  /// Adds the newest change and drops the oldest. A NaN splits what is kept: no rise and no fall is
  /// counted across it.
  void add(double change) noexcept {
    changes_[oldest_] = change;
    oldest_ = (oldest_ + 1) % changes_.size();
  }
  /// Of the changes that are kept.
  [[nodiscard]] Extent extent() const noexcept {
    Extent extent;
    Extent now;  // of what ends with the change that is looked at
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      const double change = changes_[(oldest_ + i) % changes_.size()];
      now = {std::max(0.0, now.raised + change), std::max(0.0, now.lowered - change)};
      extent = {std::max(extent.raised, now.raised), std::max(extent.lowered, now.lowered)};
    }
    return extent;
  }

 private:
  std::array<double, 16> changes_ = {};
  std::size_t oldest_ = 0;
};

}  // namespace tuina::safety
