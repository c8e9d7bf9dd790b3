// SPDX-License-Identifier: Apache-2.0
// What a fit makes of records without free air, of coarse sensors and of people who breathe.
#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/curve_fit.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr TangentTissue pressed{6.0, 220.0};

struct Made {
  double from_m = -3_mm;
  double force_noise_n = 0.05, reading_n = 0.0;  // 0: as fine as they come
  double breath_m = 0.0;
};

/// Four presses of two seconds to 15 N.
std::vector<TimedPress> record_of(const Made& made, std::uint64_t seed) {
  Random random = make_random(seed, "records to fit");
  std::vector<TimedPress> record;
  for (int i = 0; i < 8000; ++i) {
    const double t = i * 1e-3, share = 0.5 * (1.0 - std::cos(pi * t));
    const double depth_m = made.from_m + share * (depth_at_force(pressed, 15.0) - made.from_m);
    const double skin_m = 0.5 * made.breath_m * std::sin(0.5 * pi * t + 1.0);
    double felt_n =
        force_at_depth(pressed, depth_m - skin_m) + gaussian(random, made.force_noise_n);
    if (made.reading_n > 0.0) felt_n = std::round(felt_n / made.reading_n) * made.reading_n;
    record.push_back({t, {.depth_m = depth_m + gaussian(random, 0.01_mm), .force_n = felt_n}});
  }
  return record;
}

CurveFit fit_of(const Made& made, std::uint64_t seed) {
  const auto record = record_of(made, seed);
  const auto fit = fit_curve(record, estimate_noise(record));
  REQUIRE(fit.has_value());
  return *fit;
}

}  // namespace

TEST_CASE("a record that begins in contact is fitted to the end, with an interval that holds") {
  int held = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const CurveFit fit = fit_of({.from_m = 4_mm}, seed);
    CHECK(fit.settled);
    held += std::abs(fit.tissue.alpha_n - pressed.alpha_n) < fit.alpha_ci95_n &&
            std::abs(fit.tissue.beta_per_m - pressed.beta_per_m) < fit.beta_ci95_per_m;
  }
  CHECK(held >= 4);
}

TEST_CASE("a force in coarse steps is no better known than they are") {
  const SensorNoise fine = estimate_noise(record_of({.force_noise_n = 0.02}, 1));
  CHECK(fine.force_n == doctest::Approx(0.02).epsilon(0.1));
  for (const double reading_n : {0.5, 1.0}) {
    const Made made{.force_noise_n = 0.02, .reading_n = reading_n};
    CHECK(estimate_noise(record_of(made, 1)).force_n ==
          doctest::Approx(reading_n / std::sqrt(12.0)).epsilon(0.01));
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const CurveFit fit = fit_of(made, seed);
      CHECK(std::abs(fit.tissue.alpha_n - pressed.alpha_n) < fit.alpha_ci95_n);
    }
  }
}

TEST_CASE("chi tells a person who breathes from one who does not") {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    CHECK(fit_of({.breath_m = 3_mm}, seed).reduced_chi_square > max_chi_square);
    CHECK(fit_of({}, seed).reduced_chi_square < 1.2);
  }
}
