// SPDX-License-Identifier: Apache-2.0
// The guard's table of states, and the guard that runs on it, against a model that has no table:
// it knows how hard a thing is, and that a stop stays.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

constexpr std::array hardness = {0, 0, 1,
                                 2, 3, 4};  // of pass, warn, freeze, comply, retract, brake
constexpr std::array doing = {Action::pass, Action::freeze, Action::comply, Action::retract,
                              Action::brake};
constexpr int thaw_ticks = 100;

struct Model {
  int hard = 0;
  bool stopped = false;
  Cause cause = Cause::none;
  int thaws_in = 0;

  void ask(Action action, bool lasts, Cause why) {
    const int asked = hardness[static_cast<std::size_t>(action)];
    if (!stopped) hard = asked, cause = why;
    hard = std::max(hard, asked);
    stopped = stopped || asked >= 2 || (asked == 1 && lasts);
  }
};

/// What may come in a millisecond.
struct Event {
  const char* what;
  void (*happen)(Scene& scene);
  Action action;
  Cause cause;
  bool lasts = false;
  bool outside = false;  ///< somebody else stops the arm
};

const std::vector<Event> events = {
    {"nothing", [](Scene&) {}, Action::pass, Cause::none},
    {"a tick missed", [](Scene& s) { s.miss(1); }, Action::warn, Cause::late_tick},
    {"three ticks missed", [](Scene& s) { s.miss(3); }, Action::freeze, Cause::late_tick},
    {"a silent controller", [](Scene& s) { s.proposal.age_ticks = 5; }, Action::freeze,
     Cause::no_proposal},
    {"torques amiss", [](Scene& s) { s.seen.torque_misfit = 2.0; }, Action::comply,
     Cause::torques_amiss, true},
    {"too high a set force", [](Scene& s) { s.proposal.set_force_n = 46.0; }, Action::retract,
     Cause::set_force_too_high, true},
    {"no joints", [](Scene& s) { s.seen.q_rad[0] = not_a_number; }, Action::retract,
     Cause::state_not_finite, true},
    {"held", [](Scene& s) { s.guard.stop(Action::freeze, Cause::arms_too_close); }, Action::freeze,
     Cause::arms_too_close, true, true},
    {"let go", [](Scene& s) { s.guard.stop(Action::comply, Cause::person_moved); }, Action::comply,
     Cause::person_moved, true, true},
    {"sent away", [](Scene& s) { s.guard.stop(Action::retract, Cause::asked_to); }, Action::retract,
     Cause::asked_to, true, true},
    {"braked", [](Scene& s) { s.guard.stop(Action::brake, Cause::not_obeyed); }, Action::brake,
     Cause::not_obeyed, true, true}};

/// One millisecond of a guard and of its model.
void live(Scene& scene, Model& model, const Event& event) {
  event.happen(scene);
  const Verdict verdict = scene.tick();
  scene.proposal.age_ticks = 0;
  scene.proposal.set_force_n = 20.0;
  scene.seen.torque_misfit = 0.0;
  scene.seen.q_rad = standing_arm().q_rad;

  if (event.outside && !model.stopped) model.cause = event.cause, model.stopped = true;
  const bool late = event.cause == Cause::late_tick;
  if (late && event.action == Action::freeze) model.thaws_in = thaw_ticks + 1;
  model.thaws_in = std::max(0, model.thaws_in - (late && event.action == Action::warn ? 2 : 1));
  const bool frozen = model.thaws_in > 0 && event.action < Action::comply;
  const bool also = frozen && event.action < Action::freeze;
  if (event.action == Action::freeze && !late && frozen && !event.outside)
    model.ask(Action::freeze, false, Cause::late_tick);
  else
    model.ask(also ? Action::freeze : event.action, event.lasts,
              also || (frozen && late) ? Cause::late_tick : event.cause);

  CAPTURE(event.what);
  const bool warns = model.hard == 0 && event.action == Action::warn;
  CHECK(verdict.action == (warns ? Action::warn : doing[static_cast<std::size_t>(model.hard)]));
  CHECK(verdict.cause == model.cause);
  CHECK(verdict.latched == model.stopped);
}

}  // namespace

TEST_CASE(
    "a state and what is asked of it give the state that is the harder of both, and stops stay") {
  for (std::size_t state = 0; state < guard_states; ++state) {
    for (std::size_t action = 0; action < actions; ++action) {
      for (const bool lasts : {false, true}) {
        const auto now = static_cast<GuardState>(state);
        const auto next = next_state(now, static_cast<Action>(action), lasts);
        Model model{.hard = state == 0 ? 0 : std::max(1, static_cast<int>(state) - 1),
                    .stopped = state >= 2};
        model.ask(static_cast<Action>(action), lasts, Cause::none);
        CAPTURE(state);
        CAPTURE(action);
        CAPTURE(lasts);
        CHECK(is_stop(now) == (state >= 2));
        CHECK(is_stop(next) == model.stopped);
        CHECK(action_in(next, Action::pass) == doing[static_cast<std::size_t>(model.hard)]);
        CHECK(action_in(next, Action::warn) ==
              (model.hard == 0 ? Action::warn : doing[static_cast<std::size_t>(model.hard)]));
      }
    }
  }
}

TEST_CASE("a guard goes through its states as the model does, whatever three events come") {
  for (const Event& first : events) {
    for (const Event& second : events) {
      for (const Event& third : events) {
        Scene scene;
        Model model;
        scene.tick(10);
        CAPTURE(first.what);
        CAPTURE(second.what);
        CAPTURE(third.what);
        for (const Event* event : {&first, &second, &third}) live(scene, model, *event);
        for (int i = 0; i < 3; ++i) live(scene, model, events.front());
        if (model.stopped) continue;
        scene.tick(thaw_ticks);
        CHECK(scene.tick().action == Action::pass);
      }
    }
  }
}

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
    {"pushed out",
     [](Scene& s) {
       s.seen.tool_velocity_m_per_s = 0.13 * s.normal();
       s.proposal.set_force_n = 5.0;
     },
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
     Cause::torques_amiss},
    {"sensor turned round", [](Scene& s) { s.pushed_along = -s.normal(); }, Action::comply,
     Cause::force_reversed, 10},
    {"sensor stuck", [](Scene& s) { s.seen.wrist_repeats = 20; }, Action::retract,
     Cause::force_stuck},
    {"a stop from outside", [](Scene& s) { s.guard.stop(Action::freeze, Cause::arms_too_close); },
     Action::freeze, Cause::arms_too_close},
    {"no state", [](Scene& s) { s.seen.q_rad[0] = not_a_number; }, Action::retract,
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
