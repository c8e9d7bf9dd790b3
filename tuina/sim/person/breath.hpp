// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/core/random.hpp"

namespace tuina::sim {

/// Breathing motion of the back along its mean outward normal. With the first two numbers alone,
/// amplitude * (1 - cos(2 pi f t)) / 2.
struct Breathing {
  double amplitude_m = 0.0;
  double frequency_hz = 0.25;
  double variation = 0.0;       ///< 1: depth 33 %, rate 21 % from breath to breath [tobin1988]
  double sigh_share = 0.0;      ///< of the breaths are twice as deep
  double speaking_share = 0.0;  ///< of the breaths are spoken: in fast, out slowly and trembling
  double coughs_per_h = 0.0;
};

/// One breath as it was drawn.
struct Breath {
  double depth_m, rate_hz;
};
/// Draws the next breath of somebody who usually breathes so.
[[nodiscard]] Breath draw_breath(const Breathing& usual, Random& random);

/// Share of its depth that a breath has reached at a phase from 0 to 1, with its derivative: in
/// over `in_share`, out over `out_share`, then a pause.
struct BreathShare {
  double at, per_phase;
};
/// Where a breath is at a phase.
[[nodiscard]] BreathShare breath_share(double phase, double in_share = 0.5,
                                       double out_share = 0.5) noexcept;

/// How a back moves with the breaths, words and coughs of two hours, after which they come again.
class BreathCourse {
 public:
  /// Nobody breathes.
  BreathCourse() = default;
  /// Breaths of that depth and rate; the seed draws each of them, the words and the coughs.
  BreathCourse(const Breathing& breathing, std::uint64_t seed);

  /// Where the back is, and how fast.
  struct Way {
    double at_m = 0.0, speed_m_per_s = 0.0;
  };
  /// Towards the outside, from the end of breathing out. No heap.
  [[nodiscard]] Way at(double time_s) const noexcept;

 private:
  struct Drawn {
    double start_s, duration_s, depth_m;
    bool spoken;
  };
  struct Cough {
    double start_s, depth_m;
  };
  void draw(std::uint64_t seed);
  [[nodiscard]] Way breathed(double time_s) const noexcept;
  [[nodiscard]] Way coughed(double time_s) const noexcept;

  Breathing breathing_;
  std::vector<Drawn> breaths_;  // empty: every breath is like the other
  std::vector<Cough> coughs_;
};

}  // namespace tuina::sim
