// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/late_ticks.hpp"

#include <doctest/doctest.h>

#include "tests/allocation.hpp"

using namespace tuina;
using namespace tuina::record;

TEST_CASE("of a thousand milliseconds the middle one and the last ones say how late the loop is") {
  LateTicks late(1.0);
  // 0.2 ms late as a rule, 3 ms in two of a thousand, the first one quickest.
  for (int i = 0; i < 10000; ++i) {
    const double late_s = i == 0 ? 0.0 : i % 500 == 499 ? 3e-3 : 2e-4;
    late.note(7.0 + 1e-3 * i + late_s, 1e-3 * i);
  }
  late.note(7.0 + 10.0 + 40e-3, 10.0);
  const Lateness found = late.found();
  CHECK(found.ticks == 10001);
  CHECK(found.median_s == doctest::Approx(2e-4).epsilon(0.06));
  CHECK(found.p999_s == doctest::Approx(3e-3).epsilon(0.01));
  CHECK(found.max_s == doctest::Approx(40e-3));
}

TEST_CASE("at ten times the pace a millisecond of the robot has a tenth of one to be in time") {
  LateTicks late(10.0);
  for (int i = 0; i < 100; ++i) late.note(1e-4 * i, 1e-3 * i);
  CHECK(late.found().max_s < 1e-9);
}

TEST_CASE("what the robot does not catch up with is late once, and a new plan is not late") {
  LateTicks late(1.0);
  late.note(0.0, 0.0);
  for (int i = 1; i < 1000; ++i) late.note(0.5 + 1e-3 * i, 1e-3 * i);
  CHECK(late.found().max_s == doctest::Approx(0.5));
  CHECK(late.found().p999_s < 1e-4);
  late.on_plan({}, Transform::Identity());
  late.note(60.0, 1.0);
  CHECK(late.found().max_s == doctest::Approx(0.5));
}

TEST_CASE("who looks how late a millisecond is asks for no memory") {
  LateTicks late(1.0);
  const std::size_t before = test::allocations();
  for (int i = 0; i < 100; ++i) late.note(1e-3 * i, 1e-3 * i);
  CHECK(test::allocations() == before);
}
