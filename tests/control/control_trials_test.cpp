// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/control/trials.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "apps/evaluation/control/reach_trials.hpp"

using namespace tuina;
using namespace tuina::app;

TEST_CASE("a table of trials tells the worst of its runs, however many threads share them") {
  const ContactExperiment calm = {.force_n = 10.0, .duration_s = 5.0};
  ContactExperiment rising = calm;
  rising.shifts = {{2.0, Vector3(0.0, 30_mm, 0.0), 0.1}};
  const std::vector<ControlTable> fresh = {{.name = "both",
                                            .about = "",
                                            .rows = {{.labels = {{"what", "a"}},
                                                      .runs = {calm, rising},
                                                      .target = ControlTarget{.highest_n = 12.0}},
                                                     {.labels = {{"what", "a"}}, .runs = {calm}}}}};
  std::vector<ControlTable> one = fresh, two = fresh;
  Cells cells;
  REQUIRE(run_tables(one, cells, 1, {}).has_value());
  REQUIRE(run_tables(two, cells, 2, {}).has_value());
  const ControlResult &worst = one[0].rows[0].result, &quiet = one[0].rows[1].result;
  CHECK(worst.runs == 2);
  CHECK(worst.stopped == 1);
  CHECK(worst.highest_n > quiet.highest_n);
  CHECK(worst.highest_n == two[0].rows[0].result.highest_n);
  CHECK_FALSE(one[0].rows[0].target->reached(worst));
  CHECK(one[0].rows[0].target->reached(quiet));
  const ControlTable together = grouped(one[0], {"what"});
  REQUIRE(together.rows.size() == 1);
  CHECK(together.rows[0].result.runs == 3);
}

TEST_CASE("the force error of runs that ended early reaches no target") {
  const ControlTarget error = {.rmse_n = 1.0}, highest = {.highest_n = 40.0};
  CHECK(error.reached({.runs = 2, .rmse_n = 0.5}));
  CHECK_FALSE(error.reached({.runs = 2, .stopped = 1, .rmse_n = 0.5}));
  CHECK(highest.reached({.runs = 2, .stopped = 1, .highest_n = 30.0}));
}

TEST_CASE("every target is tried on three tissues, and the full form has more of everything") {
  const auto quick = control_tables(false, 1), full = control_tables(true, 1);
  REQUIRE(quick.size() == full.size());
  for (std::size_t i = 0; i < quick.size(); ++i) {
    CHECK(quick[i].name == full[i].name);
    CHECK(quick[i].rows.size() <= full[i].rows.size());
  }
  for (const ControlRow& row : full[0].rows) CHECK(row.runs.size() == 12);
  for (const ControlRow& row : full[0].rows) CHECK(row.target.has_value());
}

TEST_CASE("beyond its reach the printed law of the thesis diverges and the others do not") {
  const auto pulls = pull_beyond_reach();
  REQUIRE(pulls.size() == 3);
  CHECK_FALSE(pulls[0].survived);
  for (std::size_t i = 1; i < 3; ++i) {
    CHECK(pulls[i].survived);
    CHECK(pulls[i].max_torque_nm < 50.0);
    CHECK(pulls[i].max_speed_rad_per_s < 5.0);
  }
}

TEST_CASE("the drives hold 140 N at the tool all over a seated back") {
  const ForceAtTool force = force_at_tool();
  CHECK(force.reached == force.places);
  CHECK(force.min_n > 140.0);
  CHECK(force.reach_m == doctest::Approx(0.7));
}
