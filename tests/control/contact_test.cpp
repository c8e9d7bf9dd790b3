// SPDX-License-Identifier: Apache-2.0
// The whole loop, sensors to simulated skin, with everything wrong that a session has wrong: link
// masses by 10 %, friction by 20 %, alpha and beta by 30 %, the place of the skin by 3 mm. Judged
// on the true force.
#include <doctest/doctest.h>

#include <algorithm>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/realism.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

constexpr TangentTissue bone = {4.559, 263.2}, hard = {9.786, 185.4}, soft = {4.275, 143.6};

ContactOutcome run(const ContactExperiment& experiment) {
  auto outcome = run_contact(experiment);
  REQUIRE(outcome.has_value());
  return std::move(*outcome);
}

double last_force_n(const ContactOutcome& outcome) {
  return outcome.trace.back().true_force_n;
}

}  // namespace

TEST_CASE("a press is held to 0.8 N on bone, hard and soft muscle though the skin is 3 mm off") {
  std::uint64_t seed = 1;
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (const double force_n : {10.0, 30.0}) {
      const auto outcome = run({.tissue = tissue,
                                .force_n = force_n,
                                .surface_error_m = seed % 2 == 0 ? 3_mm : -3_mm,
                                .duration_s = 5.0,
                                .seed = seed});
      CAPTURE(seed++);
      CHECK(outcome.stops.empty());
      CHECK(outcome.force.rmse_n < 0.8);
      CHECK(outcome.force.peak_n < force_n + 3.0);
    }
  }
}

TEST_CASE("where nothing keeps to the law a press is held to 0.5 N, in a hard world to 1 N") {
  for (const std::string realism : {"usual", "hard"}) {
    session::Config config;
    config.simulation.realism = realism;
    session::set_realism(config.simulation);
    std::uint64_t seed = 1;
    for (const TangentTissue& tissue : {bone, hard, soft}) {
      ContactExperiment experiment{.tissue = tissue,
                                   .force_n = 20.0,
                                   .surface_error_m = seed % 2 == 0 ? 3_mm : -3_mm,
                                   .duration_s = 5.0,
                                   .seed = seed};
      live_in(config, experiment);
      CHECK(experiment.living.torso_mass_kg > 0.0);
      CHECK(experiment.breathing.amplitude_m > 0.0);
      const auto outcome = run(experiment);
      CAPTURE(realism);
      CAPTURE(seed++);
      CHECK(outcome.stops.empty());
      CHECK(outcome.force.rmse_n < (realism == "usual" ? 0.5 : 1.0));
      CHECK(outcome.force.peak_n < 23.0);
    }
  }
}

TEST_CASE("friction of a tool that slides over a lean nobody knows is not taken for pressing") {
  for (const std::string realism : {"usual", "hard"}) {
    session::Config config;
    config.simulation.realism = realism;
    session::set_realism(config.simulation);
    for (const TangentTissue& tissue : {bone, soft}) {
      ContactExperiment experiment{.tissue = tissue,
                                   .technique = Technique::rub,
                                   .surface_error_m = -3_mm,
                                   .surface_tilt_rad = 2_deg,
                                   .breathing = {3_mm, 0.25},
                                   .duration_s = 8.0};
      live_in(config, experiment);
      const auto outcome = run(experiment);
      CAPTURE(realism);
      CHECK(outcome.stops.empty());
      CHECK(outcome.force.rmse_n < (realism == "usual" ? 0.6 : 1.0));
    }
  }
}

TEST_CASE("60 N on bone over a rigid torso are held without ringing") {
  const auto outcome = run({.tissue = bone,
                            .force_n = 60.0,
                            .surface_error_m = 3_mm,
                            .torso_n_per_m = sim::rigid,
                            .duration_s = 5.0});
  CHECK(outcome.force.rmse_n < 1.5);
  CHECK(outcome.force.peak_n < 65.0);
}

TEST_CASE(
    "an arm without friction, and one with twice as much as its table says, hold a press alike") {
  for (const double scale : {0.0, 2.0}) {
    const auto outcome = run({.surface_error_m = 3_mm, .friction_scale = scale, .duration_s = 5.0});
    CAPTURE(scale);
    CHECK(outcome.stops.empty());
    CHECK(outcome.force.rmse_n < 0.8);
  }
}

TEST_CASE("rubbing a breathing back of unknown curve and lean holds 30 N to 1 N") {
  const auto outcome = run({.tissue = soft,
                            .technique = Technique::rub,
                            .surface_error_m = 3_mm,
                            .surface_tilt_rad = 3_deg,
                            .breathing = {3_mm, 0.25},
                            .duration_s = 7.0});
  CHECK(outcome.stops.empty());
  CHECK(outcome.force.rmse_n < 1.0);
}

TEST_CASE("a stroke of 250 mm holds 15 N to 1 N") {
  const auto outcome = run({.force_n = 15.0,
                            .technique = Technique::stroke,
                            .surface_error_m = -3_mm,
                            .surface_tilt_rad = 2_deg,
                            .breathing = {3_mm, 0.25}});
  CHECK(outcome.stops.empty());
  CHECK(outcome.force.rmse_n < 1.0);
}

TEST_CASE("a tap stays light and never leaves the skin") {
  const auto outcome = run({.tissue = soft,
                            .force_n = 10.0,
                            .technique = Technique::tap,
                            .surface_error_m = 3_mm,
                            .duration_s = 4.0});
  CHECK(outcome.stops.empty());
  CHECK(outcome.force.peak_n < 18.0);
}

TEST_CASE("skin that jumps away from under 40 N and more is not chased and not hit again") {
  for (const double force_n : {40.0, 60.0}) {
    const auto outcome = run(
        {.force_n = force_n, .duration_s = 5.0, .shifts = {{2.0, Vector3(0.0, -50_mm, 0.0), 0.5}}});
    REQUIRE(outcome.stopped);
    CHECK(outcome.max_speed_m_per_s < 0.20);
    CHECK(outcome.highest_n < force_n + 3.0);
    CHECK(outcome.second_impact_n < 30.0);
    CHECK(last_force_n(outcome) == 0.0);
  }
}

TEST_CASE("a person who rises by 30 mm is let go below 75 N, and below 90 N from under 60 N") {
  std::uint64_t seed = 1;
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (const double force_n : {30.0, 40.0, 60.0}) {
      const auto outcome = run({.tissue = tissue,
                                .force_n = force_n,
                                .duration_s = 5.0,
                                .shifts = {{2.0, Vector3(0.0, 30_mm, 0.0), 0.1}},
                                .seed = seed});
      CAPTURE(seed++);
      CHECK(outcome.highest_n < (force_n < 50.0 ? 75.0 : 90.0));
      CHECK(last_force_n(outcome) == 0.0);
    }
  }
}

TEST_CASE("a person who jumps up as fast as muscles can is let go below 90 N") {
  const auto outcome = run({.tissue = soft,
                            .force_n = 45.0,
                            .duration_s = 5.0,
                            .shifts = {{.start_s = 2.0,
                                        .by_in_couch = Vector3(0.0, 60_mm, 0.0),
                                        .speed_m_per_s = 0.4,
                                        .acceleration_m_per_s2 = 20.0}}});
  CHECK(outcome.highest_n > 50.0);
  CHECK(outcome.highest_n < 90.0);
}

TEST_CASE("a person who slides 50 mm sideways under the tool is still pressed right") {
  const auto outcome = run({.duration_s = 5.0, .shifts = {{1.5, Vector3(50_mm, 0.0, 0.0), 0.05}}});
  CHECK(outcome.stops.empty());
  CHECK(outcome.force.rmse_n < 1.0);
}

TEST_CASE("skin that is nowhere is not searched for ever") {
  const auto outcome = run({.surface_error_m = 40_mm, .duration_s = 5.0});
  REQUIRE(outcome.stops.size() == 1);
  CHECK(outcome.stops[0].cause == "no skin found");
}

TEST_CASE("the law of the thesis below the apparent mass rings where tuina's is quiet") {
  ContactExperiment experiment = {
      .tissue = bone, .surface_error_m = 0.0, .torso_n_per_m = sim::rigid, .duration_s = 4.0};
  experiment.controller.law = control::ControlLaw::thesis;
  experiment.controller.thesis = {.mass_kg = 0.5, .below_apparent_mass = true};
  const auto rings = run(experiment);
  experiment.controller.thesis = {.mass_kg = 0.5};  // raised to the apparent mass
  const auto raised = run(experiment);
  experiment.controller.law = control::ControlLaw::tuina;
  const auto quiet = run(experiment);
  CHECK(rings.force.peak_n > quiet.force.peak_n + 10.0);
  CHECK(raised.force.peak_n < rings.force.peak_n);
  CHECK(quiet.force.peak_n < 33.0);
}

TEST_CASE("the same seed gives the same force bit for bit") {
  const ContactExperiment experiment = {.duration_s = 4.0, .seed = 5};
  const auto once = run(experiment), again = run(experiment);
  REQUIRE(once.trace.size() == again.trace.size());
  CHECK(std::equal(once.trace.begin(), once.trace.end(), again.trace.begin(), [](auto& a, auto& b) {
    return a.true_force_n == b.true_force_n && a.measured_force_n == b.measured_force_n;
  }));
}

TEST_CASE(
    "two presses of a second by a breathing torso's arm know the tissue, or say they do not") {
  for (const TangentTissue& tissue : {bone, hard, soft}) {
    for (const std::uint64_t seed : {3, 4}) {
      const auto outcome = run({.tissue = tissue,
                                .force_n = 25.0,
                                .window = {.edge_s = 0.4, .hold_s = 0.05, .steepness = 4.0},
                                .breathing = {3_mm, 0.25},
                                .duration_s = 3.3,
                                .seed = seed});
      const TissueEstimate& estimate = outcome.estimate;
      CAPTURE(tissue.alpha_n);
      CHECK(estimate.presses >= 2);
      CHECK(estimate.converged);
      CHECK(estimate.tissue.alpha_n == doctest::Approx(tissue.alpha_n).epsilon(0.08));
      CHECK(estimate.tissue.beta_per_m == doctest::Approx(tissue.beta_per_m).epsilon(0.05));
    }
  }
}

TEST_CASE("every shipped robot holds a press, from where its own table has it begin") {
  for (const robot::ShippedRobot& shipped : robot::shipped_robots()) {
    CAPTURE(shipped.name);
    const auto outcome =
        run({.robot = std::string(shipped.name), .force_n = 20.0, .duration_s = 3.0});
    CHECK(outcome.stops.empty());
    CHECK(outcome.force.rmse_n < 0.8);
  }
  CHECK_FALSE(run_contact({.robot = "predecessor"}).has_value());
}
