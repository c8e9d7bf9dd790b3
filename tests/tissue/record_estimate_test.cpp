// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/record_estimate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"
#include "tuina/sim/press_scenarios.hpp"
#include "tuina/tissue/press_forecast.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

std::vector<TimedPress> some_presses() {
  Random random = make_random(5, "record estimate");
  return sim::simulate_presses({.name = "record", .about = "", .duration_s = 3.0}, {9.8, 185.4},
                               40.0, random)
      .record;
}

}  // namespace

TEST_CASE("what is said of a record at a time is what a shorter record says at its end") {
  const auto record = some_presses();
  std::vector<double> alphas;
  (void)estimate_record(record, record_options(), {}, [&](double, const TissueEstimate& now) {
    alphas.push_back(now.tissue.alpha_n);
  });
  REQUIRE(alphas.size() == record.size());
  for (const std::size_t samples : {31U, 700U, 2000U}) {
    const auto shorter = estimate_record(std::span(record).first(samples));
    CHECK(shorter.estimator.estimate().tissue.alpha_n == alphas[samples - 1]);
  }
}

TEST_CASE("noise that is known is not looked for") {
  const auto record = some_presses();
  const auto looked = estimate_record(record), half = estimate_record(record, {}, {.force_n = 0.5});
  CHECK(looked.noise.force_n == doctest::Approx(0.2).epsilon(0.15));
  CHECK(half.noise.force_n == 0.5);
  CHECK(half.noise.position_m == looked.noise.position_m);
}

TEST_CASE("a press that begins within the record, has no rows or only known forces is refused") {
  const auto record = some_presses();
  const auto made = estimate_record(record);
  const double end_s = record.back().time_s, unknown = std::numeric_limits<double>::quiet_NaN();
  const auto foretold = [&](const std::vector<TimedPress>& rows) {
    return foretell_press(made.estimator, record.front().time_s, end_s, rows);
  };
  CHECK_FALSE(foretold({}));
  CHECK_FALSE(foretold({{0.5 * end_s, {0.0, unknown}}}));
  CHECK_FALSE(foretold({{end_s + 1.0, {0.0, 0.1}}}));
  const auto told = foretold({{end_s + 1.0, {0.0, 0.1}}, {end_s + 1.001, {0.001, unknown}}});
  REQUIRE(told);
  REQUIRE(told->size() == 1);
  CHECK(told->front().band.low_n < told->front().band.high_n);
  // The first row already may be one to foretell.
  const auto at_once = foretold({{end_s + 1.0, {0.004, unknown}}});
  REQUIRE(at_once);
  CHECK(at_once->front().band.force_n > told->front().band.force_n + 1.0);
}

TEST_CASE("a row that goes back in time or is no press is named") {
  const TimedPress first{1.0, {0.001, 1.0}};
  CHECK(fault_of(first, nullptr).empty());
  CHECK(fault_of({1.0, {}}, &first) == "time_s goes from 1 to 1, it must grow");
  CHECK(fault_of({2.0, {1.5, 0.0}}, &first) ==
        "1500 mm and 0 N are no press; up to 1000 mm and 10000 N can be");
}

TEST_CASE("a press with both signs turned is named, one of an untared sensor is not") {
  const TangentTissue tissue{9.786, 185.4};
  for (const bool turned : {true, false}) {
    std::vector<TimedPress> record;
    for (int i = 0; i < 1000; ++i) {
      const double depth_m = 6e-3 * std::sin(pi * i / 1000.0), sign = turned ? -1.0 : 1.0;
      const double offset_n = turned ? 0.0 : -60.0;
      record.push_back(
          {i * 1e-3, {sign * depth_m, sign * force_at_depth(tissue, depth_m) + offset_n}});
    }
    CHECK((fault_of(record).find("both signs are turned") != std::string::npos) == turned);
    CHECK(fault_of(record).empty() == !turned);
  }
}
