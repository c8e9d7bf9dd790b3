// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace tuina::tissue {

/// Where a tool was up to 50 ms ago, at whatever rate its positions come. No heap.
class PositionDelay {
 public:
  /// Takes a position, in the order of time.
  void keep(double time_s, double position_m) noexcept;
  /// The position of a time, between those that are kept; that of the oldest before them.
  [[nodiscard]] double at(double time_s) const noexcept;
  /// Forgets all positions.
  void clear() noexcept { size_ = 0; }

 private:
  struct Timed {
    double time_s = 0.0, position_m = 0.0;
  };
  // Beyond four positions a millisecond only some are kept, and always the newest.
  static constexpr double keep_every_s = 0.25e-3;
  std::array<Timed, 256> kept_{};
  std::size_t size_ = 0, next_ = 0;
};

}  // namespace tuina::tissue
