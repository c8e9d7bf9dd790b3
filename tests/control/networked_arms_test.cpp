// SPDX-License-Identifier: Apache-2.0
// Arms at the other end of a network, in simulated time.
#include "apps/evaluation/contact/networked_arms.hpp"

#include <doctest/doctest.h>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "tuina/session/realism.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

/// Arms that count what they are told: a reading's first angle is the tick of the last command.
class CountingArms final : public robot::Robot {
 public:
  Result<void> stand_ready(const robot::ReadyPose&) override { return {}; }
  std::optional<robot::RobotReading> read() noexcept override {
    ++reading_.tick;
    reading_.time_s = 1e-3 * static_cast<double>(reading_.tick);
    return reading_;
  }
  void apply(const robot::RobotCommand& command) noexcept override {
    reading_.rail_m = command.rail_m;
    ++applied;
  }
  const char* fault() const noexcept override { return nullptr; }
  int applied = 0;

 private:
  robot::RobotReading reading_;
};

/// How many ticks lie between a state and the step that its command drives; -1: the arms stopped.
int age_after(const Network& network, int ticks) {
  CountingArms arms;
  NetworkedArms robot(arms, network, 1);
  double age = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const auto reading = robot.read();
    if (!reading || robot.stopped()) return -1;
    age = static_cast<double>(reading->tick) - reading->rail_m;
    robot.apply({.rail_m = static_cast<double>(reading->tick)});
  }
  return static_cast<int>(age);
}

}  // namespace

TEST_CASE("a command drives the step after the whole round trip, and none that is too old") {
  CHECK(age_after({}, 50) == 1);
  CHECK(age_after({.delay_s = 0.4e-3}, 50) == 1);
  CHECK(age_after({.delay_s = 1.9e-3}, 50) == 4);
  CHECK(age_after({.delay_s = 3.9e-3}, 50) == 8);
  CHECK(age_after({.delay_s = 4.6e-3}, 50) == -1);
  CHECK(age_after({.delay_s = 2e-3, .max_answer_age_cycles = 2}, 50) == -1);
  CHECK(age_after({.loss = 1.0}, 50) == -1);
}

TEST_CASE("arms that miss a command keep the last, and stop by themselves after three in a row") {
  CountingArms arms;
  NetworkedArms robot(arms, {}, 1);
  for (int i = 0; i < 5; ++i) {
    REQUIRE(robot.read().has_value());
    robot.apply({});
  }
  for (int silent = 1; silent <= 4; ++silent) {
    REQUIRE(robot.read().has_value());
    CHECK(robot.missed() == std::max(0, silent - 1));  // the fifth command was in time
    CHECK(robot.stopped() == (silent == 4));
  }
  const int applied = arms.applied;
  robot.apply({});
  REQUIRE(robot.read().has_value());
  CHECK(arms.applied == applied);  // a stopped arm obeys nobody
}

TEST_CASE("commands that are sent again bridge jitter and loss; a silent host is still noticed") {
  const Network shaken = {.delay_s = 2e-3, .jitter_s = 0.5e-3, .loss = 0.01};
  Network once = shaken;
  once.sent_again = false;
  constexpr int minute = 60'000;
  CHECK(age_after(shaken, minute) > 0);
  CHECK(age_after(once, minute) == -1);
}

TEST_CASE("arms whose states no longer come are soon driven no more") {
  CountingArms arms;
  NetworkedArms robot(arms, {.deaf_from_s = 5.5e-3}, 1);
  for (int i = 0; i < 5; ++i) {
    REQUIRE(robot.read().has_value());
    robot.apply({});
  }
  const int applied = arms.applied;
  CHECK_FALSE(robot.read().has_value());
  CHECK(robot.stopped());
  // The last command moved them once, and its copies for the 6 ms in which the host waited.
  CHECK(arms.applied - applied <= 7);
}

TEST_CASE("a network that does nothing changes no press, 2 ms spoil no short one, 5 ms end it") {
  const ContactExperiment own = {.force_n = 20.0, .duration_s = 1.5};
  ContactExperiment near = own, far = own, shaken = own, beyond = own;
  near.network = Network{};
  far.network = Network{.delay_s = 2e-3};
  shaken.network = Network{.delay_s = 2e-3, .jitter_s = 0.5e-3, .loss = 0.01};
  beyond.network = Network{.delay_s = 5e-3};
  const auto one = run_contact(own), same = run_contact(near), late = run_contact(far),
             rough = run_contact(shaken), none = run_contact(beyond);
  REQUIRE((one && same && late && rough && none));
  CHECK(same->force.rmse_n == one->force.rmse_n);
  for (const auto* outcome : {&late, &rough}) {
    for (const ContactStop& stop : (*outcome)->stops) MESSAGE(stop.time_s << " s: " << stop.cause);
    CHECK((*outcome)->stops.empty());
    CHECK((*outcome)->force.rmse_n < 1.0);
  }
  MESSAGE("N RMS: " << one->force.rmse_n << ", 2 ms each way " << late->force.rmse_n
                    << ", with jitter and loss " << rough->force.rmse_n);
  REQUIRE(none->stops.size() == 1);
  CHECK(none->stops[0].cause == "armlink broke off");
}

// The guard holds each motion against the torques that moved it, and dampers yield to the delay.
TEST_CASE("torques that come 2 ms late each way, shaken and lost, stop no press in a usual world") {
  session::Config config;
  session::set_realism(config.simulation);
  for (const Network& network : {Network{.delay_s = 1e-3}, Network{.delay_s = 2e-3},
                                 Network{.delay_s = 2e-3, .jitter_s = 0.5e-3, .loss = 0.01}}) {
    ContactExperiment late = {.force_n = 20.0, .duration_s = 3.0};
    live_in(config, late);
    late.network = network;
    const auto outcome = run_contact(late);
    REQUIRE(outcome.has_value());
    for (const ContactStop& stop : outcome->stops) MESSAGE(stop.time_s << " s: " << stop.cause);
    CHECK(outcome->stops.empty());
    CHECK(outcome->force.rmse_n < 1.0);
    MESSAGE("error " << outcome->force.rmse_n << " N RMS");
  }
}
