// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>

#include "apps/tuina/tissue_trials.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

// The targets stand for 200 runs (docs/tissue.md, `tuina evaluate tissue`); with 30 they get some
// room.
constexpr int runs = 30;

const sim::PressScenario& scenario(const std::string& name) {
  for (const auto& known : sim::press_scenarios()) {
    if (known.name == name) return known;
  }
  FAIL("no such scenario: " << name);
  return sim::press_scenarios().front();
}

TrialResult tried(const std::string& name, const TrialTissue& tissue,
                  TrialMethod method = TrialMethod::tuina) {
  return run_trials(scenario(name), tissue, runs, 77, 1)[static_cast<std::size_t>(method)];
}

}  // namespace

TEST_CASE("with nominal sensors one press is enough, on every tissue") {
  for (const TrialTissue& tissue : trial_tissues) {
    CAPTURE(std::string(tissue.name));
    const TrialResult result = tried("N0", tissue);
    CHECK(result.t95_s < 0.8);
    CHECK(result.first_press_q95 < 0.04);
    CHECK(std::abs(result.alpha_bias) < 0.006);
    CHECK(result.converged_share > 0.99);
    CHECK(result.false_converged_share == 0.0);
  }
}

TEST_CASE(
    "with poor sensors one press is enough, too, since what is felt before contact shows counts") {
  const TrialResult bone = run_trials(scenario("N1"), trial_tissues[0], 600, 77,
                                      1)[static_cast<std::size_t>(TrialMethod::tuina)];
  CHECK(bone.t95_s < 1.0);
  CHECK(bone.first_press_q95 < 0.045);
  CHECK(bone.coverage_alpha > 0.9);
}

TEST_CASE("the thesis' estimator never gets there on the same presses") {
  for (const TrialTissue& tissue : trial_tissues) {
    CHECK(std::isinf(tried("N0", tissue, TrialMethod::thesis).t95_s));
    CHECK(std::isinf(tried("N0", tissue, TrialMethod::thesis_tuned).t95_s));
  }
}

TEST_CASE(
    "intervals hold the truth, also while breathing, with damping, bias and coloured errors") {
  for (const std::string name : {"N1", "N2", "N3", "N4", "N5", "N6", "N7", "L1"}) {
    for (const TrialTissue& tissue : trial_tissues) {
      CAPTURE(name);
      CAPTURE(std::string(tissue.name));
      const TrialResult result = tried(name, tissue);
      CHECK(result.coverage_alpha > 0.8);
      CHECK(result.coverage_beta > 0.8);
      CHECK(result.false_converged_share < 0.1);
    }
  }
}

TEST_CASE(
    "by a robot, through torso, breath and a late sensor, two presses know alpha to 8 and beta to "
    "5 per cent") {
  for (const std::string name : {"L0", "L1", "L2"}) {
    for (const TrialTissue& tissue : trial_tissues) {
      CAPTURE(name);
      CAPTURE(std::string(tissue.name));
      CHECK(tried(name, tissue).last_q95 < 0.08);
    }
  }
}

TEST_CASE("who presses lightly, or on tissue of another law, does not hear that alpha is known") {
  for (const TrialTissue& tissue : trial_tissues) {
    CHECK(tried("light", tissue).converged_share == 0.0);
  }
}

TEST_CASE("the same seed gives the same trials on one thread and on two") {
  const TrialResult one = run_trials(scenario("N6"), trial_tissues[1], 8, 5, 1)[0];
  const TrialResult two = run_trials(scenario("N6"), trial_tissues[1], 8, 5, 2)[0];
  CHECK(one.last_q95 == two.last_q95);
  CHECK(one.alpha_bias == two.alpha_bias);
}
