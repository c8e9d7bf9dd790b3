// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace tuina::tissue {

/// Tells where a force sensor is at the end of its range. There it repeats its largest reading
/// while the tool goes on into the body; a coarse sensor repeats it as well, but then the tool
/// stands still. No heap.
class ForceRange {
 public:
  /// A sensor of that noise, one standard deviation of one sample.
  explicit ForceRange(double force_noise_n = 0.0) noexcept : force_noise_n_(force_noise_n) {}

  /// Takes a reading, in the order of time, and where the tool was then. True: it is no
  /// measurement, or it is not yet clear whether it is one.
  [[nodiscard]] bool saturated(double time_s, double position_m, double force_n) noexcept;

 private:
  struct Reading {
    double time_s = 0.0, position_m = 0.0, force_n = 0.0;
  };

  void keep(const Reading& reading) noexcept;
  [[nodiscard]] double stiffness_before(double position_m, double force_n) const noexcept;

  double force_noise_n_ = 0.0;
  double max_n_ = 0.0, limit_n_ = std::numeric_limits<double>::infinity();
  double resolution_n_ = std::numeric_limits<double>::infinity();  // smallest change of a reading
  double last_n_ = std::numeric_limits<double>::quiet_NaN();
  // The equal readings of now: how many, since when, the place of the first and the last of them.
  int repeats_ = 0;
  double since_s_ = 0.0, from_m_ = 0.0, at_m_ = 0.0;
  double n_per_m_ = 0.0;  // by which force rose with depth before them

  std::array<Reading, 16> kept_{};  // of the last quarter of a second
  std::size_t kept_size_ = 0, kept_next_ = 0;
};

}  // namespace tuina::tissue
