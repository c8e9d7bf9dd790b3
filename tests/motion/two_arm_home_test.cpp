// SPDX-License-Identifier: Apache-2.0
// How both arms come home: without touching, or not at all.
#include <doctest/doctest.h>

#include "tests/motion/ready_for.hpp"
#include "tuina/core/units.hpp"
#include "tuina/motion/arm_move.hpp"

using namespace tuina;
using test::ready_for;

TEST_CASE("an arm that would turn into the other one on its way home moves aside first") {
  for (const char* who : {"phantom:slim", "phantom:medium"}) {
    CAPTURE(who);
    const motion::ReadyPlan ready = ready_for(who, BodyPosture::prone, "before_and_after", 3, "ur");
    CHECK(ready.reachable);
    CHECK(ready.min_arm_distance_m >= motion::closest_arm_distance_m);
  }
}

TEST_CASE(
    "where no way home keeps the arms apart, the last path is left out and the plan says so") {
  const motion::ReadyPlan ready =
      ready_for("phantom:slim", BodyPosture::prone, "before_and_after", 3, "ur", 200_mm);
  std::size_t too_close = 0;
  for (const Sentence& note : ready.plan.notes) too_close += note.key == "note_arms_too_close";
  CHECK_FALSE(ready.reachable);
  CHECK(too_close > 0);
  CHECK(ready.plan.paths.size() + too_close == 20);
  CHECK(ready.min_arm_distance_m >= motion::closest_arm_distance_m);
  // What is left runs on as if the others had never been planned.
  std::vector<int> served(ready.plan.paths.size(), 0);
  for (const Arm arm : both_arms) {
    CHECK(ready.jobs[arm].back().posture_rad == ready.ready_rad[arm]);
    int step = -1;
    for (const motion::ArmJob& job : ready.jobs[arm]) {
      CHECK(job.step > step);
      step = job.step;
      if (job.path >= 0) ++served.at(static_cast<std::size_t>(job.path));
    }
  }
  for (const int times : served) CHECK(times == 1);
}
