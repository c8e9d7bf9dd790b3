// SPDX-License-Identifier: Apache-2.0
// What a stop is: it lasts, it keeps its first cause, and it never grows milder.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

struct Stop {
  const char* what;
  void (*spoil)(Scene& scene);
  Action action;
  Cause cause;
  int ticks = 1;  ///< that the fault must last
};

const std::vector<Stop> stops = {
    {"ten ticks missed", [](Scene& s) { s.seen.tick += 10; }, Action::retract, Cause::late_tick},
    {"encoder jumps", [](Scene& s) { s.seen.q_rad[1] -= 0.1; }, Action::comply,
     Cause::encoder_jump},
    {"joint too fast", [](Scene& s) { s.seen.dq_rad_per_s[1] = 4.0; }, Action::comply,
     Cause::joint_too_fast, 3},
    {"tool too fast", [](Scene& s) { s.seen.tool_velocity_m_per_s.x() = 0.31; }, Action::comply,
     Cause::tool_too_fast, 3},
    {"sensor silent", [](Scene& s) { s.sensor_alive = false; }, Action::retract, Cause::force_stale,
     5},
    {"force over the trip", [](Scene& s) { s.force_n = 61.0; }, Action::retract,
     Cause::force_over_trip, 4},
    {"pushed out", [](Scene& s) { s.seen.tool_velocity_m_per_s = 0.13 * s.normal(); },
     Action::retract, Cause::pushed_out, 3},
    {"no torque", [](Scene& s) { s.proposal.torque_nm[0] = infinity; }, Action::retract,
     Cause::torque_not_finite, 3},
    {"no proposal", [](Scene& s) { s.proposal.normal_in_base.setZero(); }, Action::retract,
     Cause::bad_proposal},
    {"leash", [](Scene& s) { s.proposal.stiffness_n_per_m = 3100.0; }, Action::retract,
     Cause::leash_too_long},
    {"set force", [](Scene& s) { s.proposal.set_force_n = 46.0; }, Action::retract,
     Cause::set_force_too_high},
    {"saturated", [](Scene& s) { s.proposal.torque_nm[3] = 51.0; }, Action::comply,
     Cause::torque_saturated, 100},
    {"presses too hard", [](Scene& s) { s.pull(-71.0 * s.normal()); }, Action::retract,
     Cause::inward_force, 100},
    {"torques amiss", [](Scene& s) { s.seen.torque_misfit = 2.0; }, Action::comply,
     Cause::torques_amiss, 25},
    {"sensor turned round", [](Scene& s) { s.pushed_along = -s.normal(); }, Action::comply,
     Cause::force_reversed, 10},
    {"sensor stuck", [](Scene& s) { s.noise_n = 0.0, s.seen.tool_velocity_m_per_s.x() = 0.02; },
     Action::retract, Cause::force_stuck, 22},
    {"a stop from outside", [](Scene& s) { s.guard.stop(Action::freeze, Cause::arms_too_close); },
     Action::freeze, Cause::arms_too_close},
    {"no state", [](Scene& s) { s.seen.q_rad[0] = not_a_number; }, Action::brake,
     Cause::state_not_finite},
};

/// Spoils a scene for as long as it takes, then makes all well again.
void stop(Scene& scene, const Stop& fault) {
  const Scene well = scene;
  fault.spoil(scene);
  scene.tick(fault.ticks);
  scene.seen = Observation(well.seen);
  scene.seen.tick = well.seen.tick + 1000;
  scene.seen.time_s = well.seen.time_s + 0.2;
  scene.proposal = well.proposal;
  scene.force_n = well.force_n;
  scene.pushed_along = well.pushed_along;
  scene.noise_n = well.noise_n;
  scene.sensor_alive = true;
}

}  // namespace

TEST_CASE("every stop lasts, however well all is again") {
  for (const Stop& fault : stops) {
    CAPTURE(fault.what);
    Scene scene;
    scene.tick(10);
    scene.proposal.phase = fault.cause == Cause::tool_too_fast ? Phase::free : Phase::contact;
    stop(scene, fault);
    CHECK(scene.verdict.action == fault.action);
    CHECK(scene.verdict.cause == fault.cause);
    CHECK(scene.verdict.latched);
    // The tick at which all is well again was not missed: the counter of ticks goes on.
    scene.seen.tick = scene.seen.tick - 1000 + static_cast<std::uint64_t>(fault.ticks);
    if (fault.cause == Cause::late_tick) scene.seen.tick += 9;
    scene.tick(50);
    CHECK(scene.verdict.action >= fault.action);
    CHECK(scene.verdict.cause == fault.cause);
    CHECK(scene.verdict.latched);
  }
}

TEST_CASE("a second stop keeps the cause of the first and never makes the action milder") {
  for (const Stop& first : stops) {
    for (const Stop& second : stops) {
      CAPTURE(first.what);
      CAPTURE(second.what);
      Scene scene;
      scene.tick(10);
      scene.proposal.phase = Phase::contact;
      first.spoil(scene);
      scene.tick(first.ticks);
      const Verdict before = scene.verdict;
      second.spoil(scene);
      scene.tick(second.ticks);
      CHECK(scene.verdict.action >= std::max(before.action, second.action));
      if (before.latched) CHECK(scene.verdict.cause == before.cause);
    }
  }
}

TEST_CASE("a milder stop that follows a harder one leaves it as it is, the latch too") {
  Scene scene;
  scene.tick(10);
  scene.retract();
  scene.seen.q_rad[0] += 0.1;
  CHECK(scene.tick(20).action == Action::retract);
  CHECK(scene.verdict.cause == Cause::set_force_too_high);
}

TEST_CASE(
    "of two faults in one tick the harder is done, and of equals the first that was looked for is "
    "told") {
  Scene scene;
  scene.tick(10);
  scene.proposal.set_force_n = 46.0;          // retract
  scene.proposal.stiffness_n_per_m = 3100.0;  // retract, and judged before
  scene.seen.q_rad[0] += 0.1;                 // comply
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::leash_too_long);
}

TEST_CASE("one more fault never lowers the action") {
  const std::vector<void (*)(Scene&)> faults = {
      [](Scene& s) { s.seen.tick += 1; },
      [](Scene& s) { s.seen.tick += 4; },
      [](Scene& s) { s.seen.q_rad[0] += 0.1; },
      [](Scene& s) { s.proposal.set_force_n = 99.0; },
      [](Scene& s) { s.seen.dq_rad_per_s[1] = not_a_number; },
      [](Scene& s) { s.proposal.torque_nm[0] = not_a_number; }};
  for (const auto& first : faults) {
    for (const auto& second : faults) {
      Scene one, both;
      one.tick(10), both.tick(10);
      first(one), first(both);
      second(both);
      CHECK(both.tick().action >= one.tick().action);
    }
  }
}
