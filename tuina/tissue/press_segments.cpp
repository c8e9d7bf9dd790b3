// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/press_segments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tuina::tissue {
namespace {

constexpr double block_s = 4.5e-3;     // five samples at 1 kHz
constexpr double max_segment_s = 0.1;  // the breath moves the skin little within it
constexpr double max_gap_s = 0.05;     // a dropout; the two sides are not averaged
constexpr double max_bridge_s = 0.3;   // nobody lets go and presses again within it
constexpr double min_force_n = 1.0;
// Cells of equal width in the root of the force span about equal depths on every tissue.
constexpr double cell_root_n = 0.1863;  // sqrt(80 N) / 48
constexpr double cell_m = 0.4e-3;
constexpr double min_tare_samples = 5.0;

double slope_between(const PressSegment& a, const PressSegment& b) noexcept {
  const double dt_s = b.time_s - a.time_s;
  return dt_s > 0.0 ? (b.position_m - a.position_m) / dt_s : 0.0;
}

}  // namespace

PressSegments::PressSegments(const SegmentOptions& options) noexcept
    : options_(options), range_(options.force_noise_n) {}

double PressSegments::tare_n() const noexcept {
  // A force offset of 0.3 N would otherwise cost up to 14 % of alpha.
  return free_air_.samples >= min_tare_samples ? free_air_.force_n / free_air_.samples : 0.0;
}

double PressSegments::tare_sd_n() const noexcept {
  return free_air_.samples >= min_tare_samples
             ? options_.force_noise_n / std::sqrt(free_air_.samples)
             : std::numeric_limits<double>::infinity();
}

void PressSegments::add(double time_s, const Press& sample) noexcept {
  if (!std::isfinite(time_s) || !std::isfinite(sample.depth_m) || !std::isfinite(sample.force_n))
    return;
  if (std::abs(sample.depth_m) > 1.0 || std::abs(sample.force_n) > 1e4) return;
  if (started_ && !(time_s > last_time_s_)) return;
  const double step_s = started_ ? time_s - last_time_s_ : 0.0;
  ++steps_;
  if (step_s > max_gap_s) {
    ++gaps_;
    close_block();
    open_ = false;
    positions_.clear();
    recent_size_ = 0;
    gap_ = true;
  }
  started_ = true;
  last_time_s_ = time_s;
  positions_.keep(time_s, sample.depth_m);
  const double position_m = positions_.at(time_s - options_.force_delay_s);
  const bool saturated = range_.saturated(time_s, position_m, sample.force_n);
  if (saturated != block_.saturated) close_block();
  if (block_.samples == 0.0) {
    block_start_s_ = time_s;
    block_.saturated = saturated;
    block_.after_gap = std::exchange(gap_, false);
  }
  block_.time_s += time_s - block_start_s_;
  block_.position_m += position_m;
  block_.force_n += sample.force_n;
  block_.samples += 1.0;
  // Where the next sample would come too late for it, the block ends here.
  if (block_.samples >= 5.0 || time_s + step_s - block_start_s_ >= block_s) close_block();
}

void PressSegments::close_block() noexcept {
  if (block_.samples == 0.0) return;
  const double n = block_.samples;
  Block block = std::exchange(block_, Sum{});
  block.time_s = block_start_s_ + block.time_s / n;
  block.position_m /= n;
  block.force_n /= n;
  if (options_.tool_mass_kg > 0.0)
    take_inertia_off(block);
  else
    accept(block);
}

void PressSegments::close() noexcept {
  close_block();
  open_ = false;
}

void PressSegments::take_inertia_off(const Block& newest) noexcept {
  if (recent_size_ == recent_.size()) {
    std::copy(recent_.begin() + 1, recent_.end(), recent_.begin());
    --recent_size_;
  }
  recent_[recent_size_++] = newest;
  if (recent_size_ < recent_.size()) return;
  // Acceleration from the parabola through first, middle and last. 0.15 kg at 0.2 m/s^2, a soft
  // landing, is 0.03 N, a thirtieth of the force at first touch of soft tissue.
  const Block &a = recent_.front(), &b = recent_[2], &c = recent_.back();
  const double before = (b.position_m - a.position_m) / (b.time_s - a.time_s);
  const double after = (c.position_m - b.position_m) / (c.time_s - b.time_s);
  const double acceleration = 2.0 * (after - before) / (c.time_s - a.time_s);
  Block block = b;
  block.inertia_n = options_.tool_mass_kg * acceleration;
  block.force_n -= block.inertia_n;
  accept(block);
}

void PressSegments::accept(const Block& block) noexcept {
  const double n = block.samples, time_s = block.time_s, position_m = block.position_m;
  if (!touched_ && !block.saturated) tare(position_m, block.force_n, n);
  const double force_n = block.force_n - tare_n();
  remember(time_s, force_n, block.after_gap);
  if (block.saturated) {
    open_ = false;
    if (in_contact_) follow_press(time_s, force_n);
    return;
  }
  const Block felt = {time_s, position_m, force_n, n, block.inertia_n, memory_n_};
  // Force noise must not select samples: the block that shows contact is the last of the air, and
  // contact then holds until the force is clearly gone.
  const double on_n = std::max(min_force_n, 5.0 * options_.force_noise_n / std::sqrt(n));
  const bool was_in_contact = in_contact_;
  in_contact_ = force_n > (in_contact_ ? 0.4 * on_n : on_n);
  follow_press(time_s, in_contact_ ? force_n : 0.0);
  if (!in_contact_ || !was_in_contact) {
    open_ = false;
    remember_air(felt);
  }
  if (!in_contact_) return;
  if (!was_in_contact) push_air();
  if (!touched_) {
    first_contact_s_ = time_s;
    first_contact_m_ = position_m;
  }
  touched_ = true;
  if (was_in_contact) append(felt);
}

void PressSegments::tare(double position_m, double force_n, double samples) noexcept {
  const double clear_m = -2.5 * options_.contact_sd_m;
  if (!tare_begun_) began_near_ = position_m > clear_m;
  tare_begun_ = true;
  // A record that begins close above the skin is taken to begin in free air; the force stays at its
  // start until the skin is met.
  const bool as_it_began =
      began_near_ && position_m < 0.0 &&
      (free_air_.samples == 0.0 || std::abs(force_n - free_air_.force_n / free_air_.samples) <
                                       4.0 * options_.force_noise_n / std::sqrt(samples));
  if (position_m > clear_m && !as_it_began) return;
  free_air_.force_n += samples * force_n;
  free_air_.samples += samples;
}

void PressSegments::follow_press(double time_s, double force_n) noexcept {
  // Between presses the tool keeps a light contact of 3 N, nearly half of a probing press, so a
  // press ends at a fall of the force, not at its loss, and counts once it was released.
  peak_ever_n_ = std::max(peak_ever_n_, force_n);
  if (phase_ == Phase::up) {
    peak_n_ = std::max(peak_n_, force_n);
    if (force_n < 0.5 * peak_n_) {
      phase_ = Phase::down;
      released_s_ = time_s;
    }
  }
  if (phase_ == Phase::down && (force_n <= 0.0 || time_s - released_s_ > 0.1)) {
    ++presses_;
    phase_ = Phase::rest;
    valley_n_ = force_n;
  }
  if (phase_ == Phase::rest) {
    valley_n_ = std::min(valley_n_, force_n);
    if (force_n > 1.2 * valley_n_ + 2.0 * min_force_n) {
      phase_ = Phase::up;
      peak_n_ = force_n;
    }
  }
  if (force_n <= 0.0 || phase_ == Phase::up) press_ = presses_;
}

void PressSegments::remember(double time_s, double force_n, bool after_gap) noexcept {
  // Across a long dropout nothing is known of the force; most are in the air.
  const double dt_s = time_s - remembered_s_;
  const bool unknown = after_gap && (!in_contact_ || dt_s > max_bridge_s);
  const double lasting_n = unknown || !std::isfinite(dt_s) ? 0.0 : force_n;
  remembered_s_ = time_s;
  for (std::size_t i = 0; i < memory_s.size(); ++i)
    memory_n_[i] = lasting_n + std::exp(-dt_s / memory_s[i]) * (memory_n_[i] - lasting_n);
}

void PressSegments::append(const Block& block) noexcept {
  const auto& [time_s, position_m, force_n, samples, inertia_n, memory_n, saturated, after_gap] =
      block;
  ++blocks_;
  const double root = std::sqrt(std::max(0.0, force_n));
  const double noise_n = options_.force_noise_n / std::sqrt(samples);
  const bool other_force = std::abs(root - opened_root_) > cell_root_n &&
                           std::abs(force_n - opened_root_ * opened_root_) > 6.0 * noise_n;
  const bool other_place = std::abs(position_m - opened_m_) > cell_m;
  const bool fits = open_ && size_ > 0 && !other_force && !other_place &&
                    time_s - opened_s_ < max_segment_s && time_s - last_accepted_s_ < max_gap_s;
  last_accepted_s_ = time_s;
  if (fits) {
    join(segments_[size_ - 1], block);
    return;
  }
  push({.time_s = time_s,
        .position_m = position_m,
        .force_n = force_n,
        .samples = samples,
        .inertia_n = std::abs(inertia_n),
        .memory_n = memory_n});
  open_ = true;
  opened_s_ = time_s;
  opened_root_ = root;
  opened_m_ = position_m;
  // The speed of a segment is the slope between its neighbours; the first and last of a press have
  // only one.
  const auto joined = [this](std::size_t a, std::size_t b) {
    return segments_[a].contact && segments_[b].time_s - segments_[a].time_s < 3.0 * max_segment_s;
  };
  const auto slope = [this](std::size_t a, std::size_t b) {
    return slope_between(segments_[a], segments_[b]);
  };
  if (size_ < 2 || !joined(size_ - 2, size_ - 1)) return;
  segments_[size_ - 1].speed_m_per_s = slope(size_ - 2, size_ - 1);
  const bool middle = size_ >= 3 && joined(size_ - 3, size_ - 1);
  segments_[size_ - 2].speed_m_per_s = slope(size_ - (middle ? 3 : 2), size_ - 1);
}

void PressSegments::remember_air(const Block& block) noexcept {
  const auto& [time_s, position_m, force_n, samples, inertia_n, memory_n, saturated, after_gap] =
      block;
  if (air_size_ > 0) {
    PressSegment& last = air_[air_size_ - 1];
    if (std::abs(position_m - last.position_m) < 0.5 * cell_m && last.samples < 100.0) {
      join(last, block);
      return;
    }
  }
  if (air_size_ == air_.size()) {
    std::copy(air_.begin() + 1, air_.end(), air_.begin());
    --air_size_;
  }
  air_[air_size_++] = {.time_s = time_s,
                       .position_m = position_m,
                       .force_n = force_n,
                       .samples = samples,
                       .inertia_n = std::abs(inertia_n),
                       .contact = false,
                       .memory_n = memory_n};
}

void PressSegments::join(PressSegment& segment, const Block& block) noexcept {
  const double share = block.samples / (segment.samples + block.samples);
  segment.time_s += share * (block.time_s - segment.time_s);
  segment.position_m += share * (block.position_m - segment.position_m);
  segment.force_n += share * (block.force_n - segment.force_n);
  for (std::size_t i = 0; i < memory_s.size(); ++i)
    segment.memory_n[i] += share * (block.memory_n[i] - segment.memory_n[i]);
  segment.samples += block.samples;
  segment.inertia_n = std::max(segment.inertia_n, std::abs(block.inertia_n));
}

void PressSegments::push_air() noexcept {
  for (std::size_t i = 0; i < air_size_; ++i) {
    const PressSegment &a = air_[i > 0 ? i - 1 : 0], &b = air_[std::min(i + 1, air_size_ - 1)];
    PressSegment air = air_[i];
    if (b.time_s - a.time_s < 3.0 * max_segment_s) air.speed_m_per_s = slope_between(a, b);
    push(air);
  }
  air_size_ = 0;
}

void PressSegments::push(const PressSegment& segment) noexcept {
  if (size_ == std::min(options_.max_segments, capacity)) drop_oldest(1);
  (segments_[size_++] = segment).press = press_;
}

void PressSegments::drop_oldest(std::size_t count) noexcept {
  count = std::min(count, size_);
  std::copy(segments_.begin() + static_cast<long>(count),
            segments_.begin() + static_cast<long>(size_), segments_.begin());
  size_ -= count;
}

}  // namespace tuina::tissue
