// SPDX-License-Identifier: Apache-2.0
// Contact by arms that take places and no torques, judged on the true force.
#include <doctest/doctest.h>

#include <memory>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "tuina/control/late_force.hpp"
#include "tuina/sim/robot/faulty_robot.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

constexpr sim::PositionLoop quick = sim::quick_loop, slow = sim::slow_loop;

ContactExperiment press(const sim::PositionLoop& loop, double force_n) {
  return {.robot = "ur",
          .force_n = force_n,
          .surface_error_m = 3_mm,
          .duration_s = 4.0,
          .position = loop};
}

ContactOutcome outcome_of(const ContactExperiment& experiment) {
  auto outcome = run_contact(experiment);
  REQUIRE(outcome.has_value());
  for (const ContactStop& stop : outcome->stops) MESSAGE(stop.time_s << " s: " << stop.cause);
  return std::move(*outcome);
}

/// A press in which something goes wrong with the left arm.
ContactOutcome pressed_with(const sim::PositionLoop& loop, const sim::TimedFault& fault) {
  std::unique_ptr<sim::FaultyRobot> faulty;
  ContactExperiment experiment = press(loop, 20.0);
  experiment.seen_as = [&](robot::Robot& arms) -> robot::Robot& {
    faulty = std::make_unique<sim::FaultyRobot>(arms);
    faulty->add(fault);
    return *faulty;
  };
  return outcome_of(experiment);
}

double begins_s(const ContactOutcome& outcome) {
  for (const ContactSample& sample : outcome.trace)
    if (sample.target_n > 0.0) return sample.time_s;
  return 0.0;
}

}  // namespace

TEST_CASE("arms that take places hold a force, those of 500 Hz closer than those of 125 Hz") {
  const ContactOutcome near = outcome_of(press(quick, 20.0)), far = outcome_of(press(slow, 20.0));
  MESSAGE("N RMS: 500 Hz " << near.force.rmse_n << ", 125 Hz " << far.force.rmse_n);
  CHECK(near.stops.empty());
  CHECK(far.stops.empty());
  CHECK(near.force.rmse_n < 1.0);
  CHECK(far.force.rmse_n < 2.5);
  CHECK(near.highest_n < 24.0);
  CHECK(far.highest_n < 28.0);
  CHECK(near.ripple_n < 0.5);
  CHECK(far.ripple_n < 0.5);
}

TEST_CASE("gains of an arm that takes torques ring where the arm is as late as one of 125 Hz") {
  ContactExperiment hasty = press(slow, 20.0);
  hasty.late_gains = false;
  const ContactOutcome outcome = outcome_of(hasty);
  CHECK((!outcome.stops.empty() || outcome.force.rmse_n > 3.0));
}

TEST_CASE("no lag changes no gain") {
  const control::ArmController::Options prompt;
  const auto same = control::for_late_force(prompt, 0.0),
             late = control::for_late_force(prompt, 0.04);
  CHECK(same.force.trim_per_s == prompt.force.trim_per_s);
  CHECK(same.force.sensor_lag_s == prompt.force.sensor_lag_s);
  CHECK(same.force.contact_damping_ratio == prompt.force.contact_damping_ratio);
  CHECK(late.force.trim_per_s < 0.1 * prompt.force.trim_per_s);
  CHECK(late.force.sensor_lag_s == doctest::Approx(0.044));
}

TEST_CASE("a wrist that is lost, stuck or no number in a press by places ends in a retreat") {
  using sim::RobotFault;
  struct Case {
    RobotFault kind;
    const char* cause;
    double within_s;
  };
  for (const sim::PositionLoop& loop : {quick, slow}) {
    const ContactOutcome sound = outcome_of(press(loop, 20.0));
    const double fails_s = begins_s(sound) + 2.0;
    for (const Case& one : {Case{RobotFault::wrench_dropout, "force sensor stale", 0.007},
                            Case{RobotFault::wrench_nan, "force sensor stale", 0.007},
                            Case{RobotFault::wrench_stuck, "force sensor stuck", 0.025}}) {
      INFO(loop.cycle_hz << " Hz, " << one.cause);
      const ContactOutcome outcome = pressed_with(loop, {.kind = one.kind, .onset_s = fails_s});
      REQUIRE(outcome.stops.size() == 1);
      CHECK(outcome.stops[0].cause == std::string(one.cause));
      CHECK(outcome.stops[0].time_s > fails_s);
      CHECK(outcome.stops[0].time_s < fails_s + one.within_s);
      CHECK(outcome.highest_n < sound.highest_n + 2.0);  // no more than without the fault
      CHECK(outcome.trace.back().true_force_n == 0.0);   // the tool is off the skin
    }
  }
}

TEST_CASE("a wrist that feels everything reversed does not drive the tool in: the guard ends it") {
  const ContactOutcome sound = outcome_of(press(quick, 20.0));
  const ContactOutcome outcome = pressed_with(
      quick, {.kind = sim::RobotFault::wrench_flip, .part = 0, .onset_s = begins_s(sound) + 2.0});
  REQUIRE(!outcome.stops.empty());
  CHECK(outcome.highest_n < 90.0);
  MESSAGE(outcome.stops[0].cause << ", highest " << outcome.highest_n << " N");
}

TEST_CASE("the person who goes away is not followed, and the one who rises is let go") {
  for (const sim::PositionLoop& loop : {quick, slow}) {
    for (const double by_m : {-50_mm, 30_mm}) {
      INFO(loop.cycle_hz << " Hz, " << by_m << " m");
      ContactExperiment experiment = press(loop, 20.0);
      experiment.shifts = {{.start_s = 2.0,
                            .by_in_couch = Vector3(0.0, by_m, 0.0),
                            .speed_m_per_s = by_m < 0.0 ? 0.5 : 0.1}};
      const ContactOutcome outcome = outcome_of(experiment);
      MESSAGE("highest " << outcome.highest_n << " N, second contact " << outcome.second_impact_n
                         << " N, tool " << outcome.max_speed_m_per_s << " m/s");
      CHECK(outcome.highest_n < 90.0);
      if (by_m < 0.0) CHECK(outcome.max_speed_m_per_s < 0.25);
    }
  }
}
