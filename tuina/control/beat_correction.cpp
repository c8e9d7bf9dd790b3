// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/beat_correction.hpp"

#include <algorithm>

namespace tuina::control {
namespace {

constexpr double min_gain = 0.1;
constexpr double min_beat_n = 0.5;  // above what is kept: less is no beat

}  // namespace

void BeatCorrection::begin(double strongest_n) noexcept {
  const double beat_n = std::max(strongest_n - options_.kept_n, min_beat_n);
  gain_ = std::clamp((options_.first_n - options_.kept_n) / beat_n, min_gain, options_.first_share);
  last_wanted_n_ = wanted_n_ = felt_n_ = 0.0;
  rose_ = came_ = false;
}

void BeatCorrection::learn() noexcept {
  const double beat_n = wanted_n_ - options_.kept_n;
  if (beat_n < min_beat_n) return;
  const double goal_n =
      std::min(options_.aim * wanted_n_, options_.max_rise * std::max(felt_n_, options_.kept_n));
  const double felt_n = std::max(felt_n_ - options_.kept_n, min_beat_n);
  double right = (goal_n - options_.kept_n) / felt_n;
  if (came_) right = std::min(right, options_.max_growth);
  came_ = came_ || felt_n >= options_.came_share * beat_n;
  gain_ *= 1.0 + options_.share * (right - 1.0);
  gain_ = std::clamp(gain_, min_gain, options_.max_gain);
}

double BeatCorrection::command_n(double wanted_n, double felt_n) noexcept {
  const bool rises = wanted_n > last_wanted_n_;
  last_wanted_n_ = wanted_n;
  // A new beat rises from where little is commanded, so that another gain is no jump.
  const bool low = wanted_n < options_.kept_n + 0.5 * (wanted_n_ - options_.kept_n);
  if (rises && !rose_ && low) {
    learn();
    wanted_n_ = felt_n_ = 0.0;
  }
  rose_ = rises;
  wanted_n_ = std::max(wanted_n_, wanted_n);
  felt_n_ = std::max(felt_n_, felt_n);
  return wanted_n > options_.kept_n ? options_.kept_n + gain_ * (wanted_n - options_.kept_n)
                                    : wanted_n;
}

}  // namespace tuina::control
