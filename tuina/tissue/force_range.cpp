// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/force_range.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::tissue {
namespace {

constexpr int enough_repeats = 5;  // equal readings in a row at the largest force seen
constexpr double min_force_n = 1.0;
constexpr double keep_every_s = 0.016;
// A held tool that sinks into tissue which relaxes meets what would be that share of its force,
// soon after the force has risen, and ever.
constexpr double soon_s = 0.2, sinks_soon = 0.05, sinks_ever = 0.5;
constexpr int soon_repeats = 2 * enough_repeats;
constexpr double unread_steps = 1.5;  // that a coarse sensor may leave out

}  // namespace

bool ForceRange::saturated(double time_s, double position_m, double force_n) noexcept {
  if (force_n > limit_n_) limit_n_ = std::numeric_limits<double>::infinity();
  const double change_n = std::abs(force_n - last_n_);
  if (change_n > 0.0) resolution_n_ = std::min(resolution_n_, change_n);
  if (change_n != 0.0) {
    repeats_ = 0;
    since_s_ = time_s;
    from_m_ = 0.0;
  }
  last_n_ = force_n;
  ++repeats_;
  max_n_ = std::max(max_n_, force_n);
  keep({time_s, position_m, force_n});

  constexpr double share = 1.0 / enough_repeats;
  if (repeats_ <= enough_repeats)
    at_m_ = from_m_ += share * position_m;
  else
    at_m_ += share * (position_m - at_m_);
  if (repeats_ == enough_repeats) n_per_m_ = stiffness_before(from_m_, force_n);
  if (repeats_ >= enough_repeats && force_n >= max_n_ && force_n > min_force_n) {
    const bool soon = time_s - since_s_ < soon_s || repeats_ < soon_repeats;
    const double unfelt_n = n_per_m_ * (at_m_ - from_m_);
    if (unfelt_n > std::max((soon ? sinks_soon : sinks_ever) * force_n,
                            unread_steps * std::min(resolution_n_, force_n)))
      limit_n_ = force_n;
    else if (soon)
      return true;
  }
  // Just below the end of the range noise decides which readings reach it.
  return force_n > limit_n_ - 4.0 * force_noise_n_;
}

void ForceRange::keep(const Reading& reading) noexcept {
  const std::size_t newest = (kept_next_ + kept_.size() - 1) % kept_.size();
  if (kept_size_ > 0 && reading.time_s - kept_[newest].time_s < keep_every_s) return;
  kept_[kept_next_] = reading;
  kept_next_ = (kept_next_ + 1) % kept_.size();
  kept_size_ = std::min(kept_size_ + 1, kept_.size());
}

double ForceRange::stiffness_before(double position_m, double force_n) const noexcept {
  // Less of a rise may be noise.
  const double clear_n = std::max(0.15 * force_n, 6.0 * force_noise_n_);
  for (std::size_t i = 1; i <= kept_size_; ++i) {
    const Reading& before = kept_[(kept_next_ + kept_.size() - i) % kept_.size()];
    const double rise_n = force_n - before.force_n, way_m = position_m - before.position_m;
    if (rise_n > clear_n) return way_m > 0.0 ? rise_n / way_m : 0.0;
  }
  return 0.0;
}

}  // namespace tuina::tissue
