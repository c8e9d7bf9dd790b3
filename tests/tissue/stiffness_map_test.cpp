// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/stiffness_map.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/body_condition.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

/// Pressed every 30 mm over a back of 300 mm by 300 mm, stiffer to the right.
std::vector<FeltPlace> pressed(double softer, std::uint64_t seed, double sd = 0.01) {
  Random random = make_random(seed, "map");
  std::vector<FeltPlace> places;
  for (int i = 0; i <= 10; ++i) {
    for (int j = 0; j <= 10; ++j) {
      const Vector3 at(30_mm * i, 0.0, 30_mm * j);
      places.push_back({at, 1.0 + 2.0 * at.x() - softer + gaussian(random, sd), sd});
    }
  }
  return places;
}

}  // namespace

TEST_CASE("between pressed places the map is smooth and right, with an honest interval") {
  const StiffnessMap map(pressed(0.0, 1));
  int inside = 0, all = 0;
  for (double x = 15_mm; x < 290_mm; x += 30_mm) {
    for (double z = 15_mm; z < 290_mm; z += 30_mm) {
      const auto value = map.at({x, 0.0, z});
      REQUIRE(value.has_value());
      CHECK(value->log_stiffness == doctest::Approx(1.0 + 2.0 * x).epsilon(0.02));
      inside += std::abs(value->log_stiffness - 1.0 - 2.0 * x) < 1.96 * value->sd;
      ++all;
    }
  }
  CHECK(inside >= 0.9 * all);
}

TEST_CASE("where nothing was pressed the map is blank") {
  const StiffnessMap map(pressed(0.0, 2));
  CHECK_FALSE(map.at({0.5, 0.0, 0.15}).has_value());
  CHECK_FALSE(StiffnessMap({}).at(Vector3::Zero()).has_value());
  CHECK_FALSE(change_at(map, StiffnessMap({}), {0.15, 0.0, 0.15}).has_value());
}

TEST_CASE("a tenth of softening is told, the same back pressed twice is no detectable change") {
  const StiffnessMap before(pressed(0.0, 3)), same(pressed(0.0, 4)), softer(pressed(0.1, 5));
  int falsely = 0, rightly = 0, all = 0;
  for (double x = 0.0; x <= 300_mm; x += 30_mm) {
    for (double z = 0.0; z <= 300_mm; z += 30_mm) {
      const Vector3 point(x, 0.0, z);
      falsely += change_at(before, same, point)->told;
      const auto change = change_at(before, softer, point);
      rightly += change->told && change->log_change < 0.0;
      ++all;
    }
  }
  CHECK(falsely <= 0.08 * all);
  CHECK(rightly >= 0.98 * all);
}

TEST_CASE("what is compared is the first and the last visit of a place, if there were two") {
  const auto visit = [](const char* name, double x, double log_stiffness) {
    return Visit{name, {.at_in_couch = {x, 0.0, 0.0}, .log_stiffness = log_stiffness, .sd = 0.01}};
  };
  const std::vector<Visit> visits = {visit("a", 0.0, 1.0), visit("b", 0.3, 1.2),
                                     visit("a", 0.0, 5.0), visit("c", 0.6, 1.0),
                                     visit("a", 0.0, 0.8), visit("c", 0.6, 1.01)};
  CHECK(last_visits(visits).size() == 3);
  const auto compared = compare_visits(visits);
  REQUIRE(compared.size() == 2);
  CHECK(compared[0].name == "a");
  CHECK(compared[0].change.told);
  CHECK(compared[0].change.log_change == doctest::Approx(-0.2).epsilon(0.01));
  CHECK(compared[1].name == "c");
  CHECK_FALSE(compared[1].change.told);
  CHECK(compare_visits(std::span(visits).first(2)).empty());
}

TEST_CASE("the stiffness of a press is known as well as repeated presses show") {
  // Three tissues, pressed anew 60 times each: the spread of what was found is what was said.
  Random random = make_random(6, "stiffness of presses");
  for (const TangentTissue truth : {TangentTissue{4.559, 263.2}, {9.786, 185.4}, {4.275, 143.6}}) {
    const double peak_m = depth_at_force(truth, 3.0 * truth.alpha_n);
    double sum = 0.0, squares = 0.0, said = 0.0;
    constexpr int runs = 60;
    for (int run = 0; run < runs; ++run) {
      PressEstimator estimator;
      for (int k = 0; k < 2500; ++k) {
        const double time_s = 1e-3 * k;
        const double depth_m = (peak_m + 2_mm) * std::abs(std::sin(pi * time_s)) - 2_mm;
        const double force_n = force_at_depth(truth, depth_m);
        estimator.update(time_s,
                         {depth_m + gaussian(random, 0.05_mm), force_n + gaussian(random, 0.2)});
      }
      const double off =
          std::log(estimator.stiffness_n_per_m(10.0) / stiffness_at_force(truth, 10.0));
      sum += off;
      squares += off * off;
      said += estimator.stiffness_sd(10.0) / runs;
    }
    const double spread = std::sqrt(squares / runs);
    CAPTURE(truth.alpha_n);
    CAPTURE(spread);
    CAPTURE(said);
    CHECK(std::abs(sum / runs) < 0.01);
    CHECK(spread < 1.3 * said);
    CHECK(said < 0.06);
  }
}

TEST_CASE("slim and hefty people of Table 6-2 are told apart by the other six") {
  const auto table = table_6_2();
  int right = 0, opposite = 0;
  for (std::size_t left_out = 0; left_out < table.size(); ++left_out) {
    std::vector<Subject> others;
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (i != left_out) others.push_back(table[i]);
    }
    std::vector<KnownPress> presses;
    for (std::size_t k = 0; k < 3; ++k)
      presses.push_back({table[left_out].tissue[k], static_cast<TissueClass>(k)});
    const BodyCondition found = find_body_condition(presses, {}, others);
    CHECK(found.slim + found.medium + found.hefty == doctest::Approx(1.0));
    const std::string build = table[left_out].build;
    const double best = std::max({found.slim, found.medium, found.hefty});
    right += (build == "slim" ? found.slim : build == "hefty" ? found.hefty : found.medium) == best;
    opposite +=
        (build == "slim" && found.hefty == best) || (build == "hefty" && found.slim == best);
  }
  MESSAGE("build, one person left out: " << right << " of 7");
  CHECK(right >= 4);
  CHECK(opposite == 0);
}

TEST_CASE(
    "body mass index and body fat are used when given, and nothing known stays nothing known") {
  const BodyCondition nothing = find_body_condition({});
  CHECK(nothing.slim == doctest::Approx(1.0 / 3.0));
  CHECK(nothing.female == doctest::Approx(0.5));
  CHECK(find_body_condition({}, {.mass_index = 31.0}).hefty > 0.9);
  CHECK(find_body_condition({}, {.mass_index = 18.5}).slim > 0.8);
  CHECK(find_body_condition({}, {.fat_percent = 8.0}).slim > 0.8);
  // A quarter of fat is much in a man and usual in a woman.
  const BodyCondition either = find_body_condition({}, {.fat_percent = 24.0});
  CHECK(either.hefty > 0.4);
  CHECK(either.medium > 0.3);
  CHECK(either.slim < 0.1);
}
