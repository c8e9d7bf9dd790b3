// SPDX-License-Identifier: Apache-2.0
// The whole loop, sensors to simulated skin, with everything wrong that a session has wrong: link
// masses by 10 %, friction by 20 %, alpha and beta by 30 %, the place of the skin by 3 mm. Judged
// on the true force.
#include <doctest/doctest.h>

#include "apps/tuina/contact_experiment.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

constexpr TangentTissue bone = {4.559, 263.2}, hard = {9.786, 185.4}, soft = {4.275, 143.6};

ContactOutcome run(const ContactExperiment& experiment) {
  auto outcome = run_contact(experiment);
  REQUIRE(outcome.has_value());
  return std::move(*outcome);
}

}  // namespace

TEST_CASE(
    "a press of 20 to 30 N is held on bone, hard and soft muscle though the skin is 3 mm off") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (const double error_m : {-3_mm, 3_mm}) {
      for (const double force_n : {20.0, 30.0}) {
        const auto outcome = run({.tissue = tissue,
                                  .force_n = force_n,
                                  .surface_error_m = error_m,
                                  .duration_s = 5.0,
                                  .seed = static_cast<std::uint64_t>(force_n + 1e3 * error_m)});
        CAPTURE(tissue.alpha_n);
        CAPTURE(error_m);
        CAPTURE(force_n);
        CHECK(outcome.stops.empty());
        CHECK(outcome.force.rmse_n < 2.0);
        CHECK(outcome.force.peak_n < force_n + 8.0);
      }
    }
  }
}
