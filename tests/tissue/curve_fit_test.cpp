// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/curve_fit.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/sim/press_scenarios.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr std::array<TangentTissue, 3> table_6_1 = {
    {{4.559, 263.2}, {9.786, 185.4}, {4.275, 143.6}}};
constexpr std::array<double, 3> peak_n = {30.0, 60.0, 60.0};

sim::SimulatedPresses one_press(std::size_t tissue, std::uint64_t seed, double force_share = 1.0) {
  sim::PressScenario scenario{
      .name = "one press", .about = "", .force_share = force_share, .duration_s = 1.0};
  Random random = make_random(seed, "curve fit");
  return sim::simulate_presses(scenario, table_6_1[tissue], peak_n[tissue], random);
}

}  // namespace

TEST_CASE("a batch fit of one press has the noise of the record, no bias, and honest intervals") {
  for (std::size_t k = 0; k < 3; ++k) {
    int covered_alpha = 0, covered_beta = 0;
    double bias = 0.0;
    const int runs = 60;
    for (int seed = 0; seed < runs; ++seed) {
      const auto press = one_press(k, static_cast<std::uint64_t>(seed));
      const auto fit = fit_curve(press.record, estimate_noise(press.record));
      REQUIRE(fit.has_value());
      const double error = fit->tissue.alpha_n - press.truth.alpha_n;
      CHECK(std::abs(error) < 0.05 * press.truth.alpha_n);
      bias += error / press.truth.alpha_n / runs;
      covered_alpha += std::abs(error) < fit->alpha_ci95_n;
      covered_beta +=
          std::abs(fit->tissue.beta_per_m - press.truth.beta_per_m) < fit->beta_ci95_per_m;
    }
    CHECK(std::abs(bias) < 0.005);
    CHECK(covered_alpha > 50);
    CHECK(covered_beta > 50);
    CHECK(covered_alpha + covered_beta <
          2 * runs);  // an interval that always holds says too little
  }
}

TEST_CASE("the noise of a record is read from the record, presses or not") {
  const auto press = one_press(1, 5);
  const SensorNoise noise = estimate_noise(press.record);
  CHECK(noise.force_n == doctest::Approx(0.2).epsilon(0.15));
  CHECK(noise.position_m == doctest::Approx(0.05_mm).epsilon(0.15));
}

TEST_CASE("an offset of the force sensor and one of the position move nothing but themselves") {
  const auto press = one_press(1, 6);
  auto moved = press.record;
  for (TimedPress& sample : moved) {
    sample.press.force_n += 1.7;
    sample.press.depth_m += 0.8_mm;
  }
  const SensorNoise noise{};
  const auto a = fit_curve(press.record, noise), b = fit_curve(moved, noise);
  REQUIRE(a.has_value());
  REQUIRE(b.has_value());
  CHECK(b->tissue.alpha_n == doctest::Approx(a->tissue.alpha_n).epsilon(1e-3));
  CHECK(b->tissue.beta_per_m == doctest::Approx(a->tissue.beta_per_m).epsilon(1e-3));
  CHECK(b->offset_n - a->offset_n == doctest::Approx(1.7).epsilon(1e-3));
  CHECK(b->contact_m - a->contact_m == doctest::Approx(0.8_mm).epsilon(1e-2));
}

TEST_CASE("a sensor that ends at 20 N takes away its part of the curve, not the answer") {
  auto press = one_press(1, 7);
  for (TimedPress& sample : press.record)
    sample.press.force_n = std::min(sample.press.force_n, 20.0);
  const auto fit = fit_curve(press.record, estimate_noise(press.record));
  REQUIRE(fit.has_value());
  CHECK(fit->tissue.alpha_n == doctest::Approx(9.786).epsilon(0.06));
}

TEST_CASE("a light press is fitted with an interval that says how little it knows") {
  const auto press = one_press(0, 8, 0.07);
  const auto fit = fit_curve(press.record, estimate_noise(press.record));
  REQUIRE(fit.has_value());
  CHECK(fit->alpha_ci95_n > 0.3 * fit->tissue.alpha_n);
}

TEST_CASE("a record without contact is refused with the reason") {
  std::vector<TimedPress> air;
  Random random = make_random(9, "air");
  for (int i = 0; i < 1000; ++i)
    air.push_back({i * 1e-3, {.depth_m = -5_mm + i * 3e-6, .force_n = gaussian(random, 0.2)}});
  const auto fit = fit_curve(air, estimate_noise(air));
  REQUIRE_FALSE(fit.has_value());
  CHECK(fit.error().fault == Fault::not_found);
}
