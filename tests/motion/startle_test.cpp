// SPDX-License-Identifier: Apache-2.0
// A person who starts up against an arm: what they meet, and how much may then be pressed.
#include <doctest/doctest.h>

#include "tuina/motion/startle.hpp"

using namespace tuina;

TEST_CASE("the heavier an arm and the more it presses, the more a person meets who starts up") {
  const TangentTissue hard = {.alpha_n = 11.5, .beta_per_m = 250.0};
  double before_n = 0.0;
  for (const double mass_kg : {2.0, 3.0, 4.0, 5.0, 6.0, 7.0}) {
    CAPTURE(mass_kg);
    const double met_n = motion::startle_force_n(mass_kg, 20.0, hard);
    CHECK(met_n > before_n);
    CHECK(motion::startle_force_n(mass_kg, 25.0, hard) > met_n);
    before_n = met_n;
  }
  // Seven kilograms are more than a person may meet, with whatever force they press.
  CHECK(before_n > motion::max_startle_n);
}

TEST_CASE(
    "a light arm may press as it is asked to, a heavy one with what a start leaves below 75 N") {
  using massage::Zone;
  CHECK(motion::max_pressing_n(2.0, Zone::muscle, 30.0) == 30.0);
  for (const Zone zone : {Zone::muscle, Zone::ribs}) {
    const double heavy_n = motion::max_pressing_n(5.5, zone, 30.0);
    CHECK(heavy_n > 0.0);
    CHECK(heavy_n < 30.0);
    CHECK(heavy_n < motion::max_pressing_n(5.0, zone, 30.0));
  }
  CHECK(motion::max_pressing_n(5.5, Zone::ribs, 30.0) <
        motion::max_pressing_n(5.5, Zone::muscle, 30.0));
}
