// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/press_segments.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue tissue_pressed{6.0, 220.0};

/// What is remembered after 20 s at 15 N, to which the force rose within a second.
Memory after_a_hold(double step_s, double reading_n) {
  PressSegments segments({.force_noise_n = 0.03, .contact_sd_m = 1_mm});
  Random random = make_random(1, "hold");
  for (double t = 0.0; t < 21.5; t += step_s) {
    const double force_n = 15.0 * std::clamp(t - 0.5, 0.0, 1.0);
    const double felt_n = force_n + gaussian(random, 0.01);
    const double depth_m = force_n > 0.0 ? depth_at_force(tissue_pressed, force_n) : -4_mm;
    segments.add(
        t, {.depth_m = depth_m + gaussian(random, 0.01_mm),
            .force_n = reading_n > 0.0 ? std::round(felt_n / reading_n) * reading_n : felt_n});
  }
  return segments.memory_n();
}

}  // namespace

TEST_CASE(
    "what tissue remembers of a hold depends neither on the rate of samples nor on rounding") {
  const Memory fine = after_a_hold(1e-3, 0.0);
  CHECK(fine[0] == doctest::Approx(15.0).epsilon(0.01));
  CHECK(fine[2] == doctest::Approx(15.0 * (1.0 - std::exp(-20.5 / 12.0))).epsilon(0.01));
  for (const Memory& other : {after_a_hold(1.0 / 30.0, 0.0), after_a_hold(1.0 / 21.0, 0.0),
                              after_a_hold(1e-3, 0.1), after_a_hold(1e-3, 0.5)}) {
    for (std::size_t i = 0; i < other.size(); ++i)
      CHECK(other[i] == doctest::Approx(fine[i]).epsilon(0.01));
  }
}

TEST_CASE("across a short dropout a press goes on, across a long one nothing is known of it") {
  for (const double dropout_s : {0.1, 3.0}) {
    PressSegments segments({.force_noise_n = 0.03});
    for (double t = 0.0; t < 4.0; t += 1e-3) {
      if (t > 0.9 && t < 0.9 + dropout_s) continue;
      const bool touches = t > 0.1;
      segments.add(t, {.depth_m = touches ? 5_mm : -4_mm, .force_n = touches ? 10.0 + t : 0.0});
      if (t > 0.9 + dropout_s) break;
    }
    if (dropout_s < 1.0)
      CHECK(segments.memory_n()[0] > 9.0);
    else
      CHECK(segments.memory_n()[0] < 1.0);
  }
}

TEST_CASE("readings at the end of a sensor's range are no forces, but they are remembered") {
  constexpr double end_n = 18.0;
  PressSegments segments({.force_noise_n = 0.05, .contact_sd_m = 1_mm});
  Random random = make_random(2, "range");
  for (double t = 0.0; t < 6.0; t += 1e-3) {
    const double share = 0.5 * (1.0 - std::cos(pi * t));
    const double depth_m = -3_mm + share * (3_mm + depth_at_force(tissue_pressed, 25.0));
    segments.add(t, {.depth_m = depth_m + gaussian(random, 0.01_mm),
                     .force_n = std::min(
                         end_n, force_at_depth(tissue_pressed, depth_m) + gaussian(random, 0.05))});
  }
  segments.close();
  double highest_n = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (!segments[i].contact) continue;
    highest_n = std::max(highest_n, segments[i].force_n);
    const double true_n = force_at_depth(tissue_pressed, segments[i].position_m);
    worst = std::max(worst, std::abs(segments[i].force_n - true_n));
  }
  CHECK(segments.presses() >= 2);
  CHECK(highest_n > 16.0);
  CHECK(highest_n < end_n - 0.1);
  CHECK(worst < 0.5);
}

TEST_CASE("a force that comes 20 or 50 ms late is set beside its position at any rate") {
  for (const double step_s : {1e-3, 0.2e-3, 0.05e-3}) {
    for (const double late_s : {0.02, 0.05}) {
      PressSegments segments({.force_noise_n = 0.05, .force_delay_s = late_s});
      const auto depth_m = [](double t) { return 4_mm * std::sin(2.0 * pi * std::max(0.0, t)); };
      for (double t = 0.0; t < 0.3; t += step_s) {
        const double force_n = force_at_depth(tissue_pressed, depth_m(t - late_s));
        segments.add(t, {.depth_m = depth_m(t), .force_n = force_n});
      }
      segments.close();
      REQUIRE(segments.size() > 5);
      for (std::size_t i = 0; i < segments.size(); ++i) {
        const double true_m = depth_at_force(tissue_pressed, segments[i].force_n);
        if (segments[i].contact) CHECK(std::abs(segments[i].position_m - true_m) < 0.05_mm);
      }
    }
  }
}
