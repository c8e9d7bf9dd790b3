// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/laser_light.hpp"

#include <doctest/doctest.h>

#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::sim;

TEST_CASE("red light leaves a scanner, its room and skin as they are") {
  LaserScannerOptions red{.room_light_dn = 60.0};
  red.flaws = {.scatter_m = 0.4_mm, .dark_share = 0.7};
  const LaserScannerOptions lit = lit_by(LaserLight::red, Lamp::incandescent, red);
  CHECK(lit.amplitude_dn == red.amplitude_dn);
  CHECK(lit.room_light_dn == doctest::Approx(red.room_light_dn));
  CHECK(lit.flaws.scatter_m == doctest::Approx(red.flaws.scatter_m));
  CHECK(lit.flaws.dark_share == doctest::Approx(red.flaws.dark_share));
}

// 0.78 mW at 850 nm is what makers print of class 1; 10^(0.002 108) of 0.39 mW at 808 nm.
TEST_CASE("an infrared laser that nobody blinks at may have two thirds of a milliwatt") {
  CHECK(max_power_w(LaserLight::red) == 1e-3);
  CHECK(1e3 * max_power_w(LaserLight::infrared) == doctest::Approx(0.641).epsilon(0.002));
  CHECK(line_share(LaserLight::infrared) == doctest::Approx(0.321).epsilon(0.002));
}

TEST_CASE("in infrared light goes farther in skin, and dark skin sends back more of it") {
  LaserScannerOptions red;
  red.flaws = {.scatter_m = 0.4_mm, .dark_share = 0.7};
  const LaserScannerOptions lit = lit_by(LaserLight::infrared, Lamp::led, red);
  CHECK(to_mm(lit.flaws.scatter_m) == doctest::Approx(0.463).epsilon(0.005));
  CHECK(lit.flaws.dark_share == doctest::Approx(0.406).epsilon(0.01));
}

TEST_CASE("behind an infrared filter LEDs are gone, daylight is half, filaments are as bright") {
  const auto share = [](Lamp lamp) { return room_share(LaserLight::infrared, lamp); };
  CHECK(share(Lamp::led) < 0.01);
  CHECK(share(Lamp::daylight) == doctest::Approx(0.454).epsilon(0.01));
  CHECK(share(Lamp::incandescent) == doctest::Approx(1.044).epsilon(0.01));
}
